// etcm-gateway: its command line.
#include <unistd.h>

#include <CLI/CLI.hpp>
#include <cstdio>
#include <cstdlib>
#include <exception>
#include <functional>
#include <memory>
#include <string>
#include <system_error>
#include <utility>
#include <vector>

#include "command_line/command_line.h"
#include "firmware/app/broker_link.h"
#include "firmware/app/control_client.h"
#include "firmware/app/program.h"
#include "firmware/config/configuration.h"
#include "firmware/config/settings_text.h"
#include "firmware/logging/limited_log.h"
#include "firmware/publish/mesh_registers.h"
#include "firmware/status/recent_events.h"
#include "posix/exhaustion.h"
#include "posix/steady_clock.h"
#include "posix/stream_log.h"
#ifdef ETCM_WITH_PROJ
#include "proj/proj_source.h"
#endif

namespace {

using namespace etcm;

constexpr int exit_bad_settings = 2;

// Runs the gateway, or only checks its settings.
int run(const CLI::App& app, const std::string& config, bool is_check, bool is_verbose) {
  const port::SteadyClock clock;
  port::StreamLog log(STDERR_FILENO, is_verbose ? port::Level::detail : port::Level::info);
  try {
    std::vector<std::string> mistakes;
    port::ProjectionSource* projections = nullptr;
#ifdef ETCM_WITH_PROJ
    port::ProjSource proj;
    projections = &proj;
#endif
    auto settings = std::make_shared<const firmware::Settings>(
        firmware::read_configuration(config, projections, mistakes));
    if (mistakes.empty()) {
      const std::string what = firmware::broker_mistake(*settings, is_check);
      if (!what.empty()) mistakes.push_back(config + ": " + what);
    }
    for (const std::string& mistake : mistakes) {
      // With --check-config they are printed as they are; of a service they are errors in its log.
      if (is_check) {
        std::fprintf(stderr, "%s\n", mistake.c_str());
      } else {
        log.write(port::Level::error, mistake);
      }
    }
    if (!mistakes.empty()) return exit_bad_settings;
    for (const std::string& warning : settings->warnings) {
      if (is_check) {
        std::fprintf(stderr, "warning: %s\n", warning.c_str());
      } else {
        log.write(port::Level::warning, warning);
      }
    }
    if (is_check) {
      std::printf("%s: good\n", config.c_str());
      return command_line::finish(app, EXIT_SUCCESS);
    }
    // Before both: noise fills neither the log nor the events of the status page.
    firmware::RecentEvents events(clock, log);
    firmware::LimitedLog limited(events, clock);
    firmware::Program(config, std::move(settings), projections, clock, limited, events).run();
    limited.flush();
    return EXIT_SUCCESS;
  } catch (const std::system_error& error) {
    std::string why = std::string("cannot start: ") + error.what();
    if (port::is_out_of_descriptors(error.code().value())) {
      why += std::string("; ") + port::descriptors_cure + " (systemctl edit etcm-gateway)";
    }
    log.write(port::Level::error, why);
    return EXIT_FAILURE;
  } catch (const std::exception& error) {
    log.write(port::Level::error, error.what());
    return EXIT_FAILURE;
  }
}

}  // namespace

int main(int argc, char** argv) {
  CLI::App app(
      "Collects node positions over Modbus, keeps a conforming Delaunay mesh of them, and "
      "publishes it as Modbus registers and files.",
      "etcm-gateway");
  std::string config;
  bool check_config = false;
  bool is_verbose = false;
  bool register_map = false;
  bool settings_file = false;
  bool settings_table = false;
  auto* config_option = app.add_option("--config", config, "settings, a TOML file");
  auto* check_option = app.add_flag("--check-config", check_config, "check the settings and end");
  app.add_flag("--verbose", is_verbose, "tell figures of each change of the mesh too")
      ->needs(config_option);
  auto* map_option = app.add_flag("--register-map", register_map,
                                  "print the tables of the registers it serves, and end");
  auto* settings_option = app.add_flag(
      "--settings", settings_file, "print a settings file with every key and its default, and end");
  auto* table_option =
      app.add_flag("--settings-table", settings_table, "print the table of the settings, and end");
  check_option->needs(config_option);
  for (CLI::Option* option : {map_option, settings_option, table_option}) {
    option->excludes(config_option);
  }
  std::function<int()> control;
  firmware::add_control_command(app, control);
  app.set_version_flag("--version", "etcm-gateway " ETCM_VERSION, "print the version and end");
  try {
    app.parse(argc, argv);
  } catch (const CLI::Success& success) {
    return command_line::finish(app, app.exit(success));
  } catch (const CLI::ParseError& error) {
    return command_line::complain(app, command_line::exit_bad_usage,
                                  std::string(error.what()) + " (etcm-gateway --help tells more)");
  }

  if (control) return command_line::finish(app, control());
  if (register_map) std::fputs(firmware::describe_mesh_registers().c_str(), stdout);
  if (settings_file) std::fputs(firmware::print_settings().c_str(), stdout);
  if (settings_table) std::fputs(firmware::describe_settings().c_str(), stdout);
  if (register_map || settings_file || settings_table) {
    return command_line::finish(app, EXIT_SUCCESS);
  }
  if (config.empty()) {
    return command_line::complain(
        app, command_line::exit_bad_usage,
        "--config is missing; give the path of the settings, such as --config site.toml");
  }
  return run(app, config, check_config, is_verbose);
}
