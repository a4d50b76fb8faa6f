#include "command_line/command_line.h"

#include <cstdio>
#include <iostream>
#include <string>
#include <vector>

namespace etcm::command_line {
namespace {

bool has_positional_argument(const CLI::App& app) {
  const auto given = app.get_options(
      [](const CLI::Option* each) { return each->get_positional() && each->count() > 0; });
  return !given.empty();
}

// Of it and its commands: words that nobody knows are gathered, whatever else is wrong.
void keep_unknown_words(CLI::App& app) {
  app.allow_extras();
  for (CLI::App* const each : app.get_subcommands([](CLI::App*) { return true; })) {
    keep_unknown_words(*each);
  }
}

// What is wrong with the line; empty: nothing. Who mistypes an option is told of that word, and not
// that the right one is missing.
std::string mistake_of(const CLI::App& app, const CLI::ParseError* error) {
  std::vector<std::string> unknown = app.remaining(true);
  // It says that no option follows, and CLI11 gathers it too.
  std::erase(unknown, "--");
  const bool is_missing =
      error != nullptr && error->get_exit_code() == static_cast<int>(CLI::ExitCodes::RequiredError);
  if (!unknown.empty() && (error == nullptr || is_missing)) {
    return CLI::ExtrasError(app.get_name(), unknown).what();
  }
  return error == nullptr ? "" : error->what();
}

}  // namespace

int complain(const CLI::App& app, int code, const std::string& message) {
  std::cerr << app.get_name() << ": " << message << std::endl;
  return code;
}

int finish(const CLI::App& app, int code) {
  std::cout.flush();
  const bool is_written = std::fflush(stdout) == 0 && std::ferror(stdout) == 0 && std::cout.good();
  if (is_written) return code;
  return complain(app, exit_no_output,
                  "the output cannot be written; make room for it, or give it another place");
}

std::optional<int> parse(CLI::App& app, int argc, const char* const* argv) {
  const std::string& name = app.get_name();
  // A group of options is one too, without a name.
  const auto all = app.get_subcommands([](CLI::App* each) { return !each->get_name().empty(); });
  const bool wants_command = !all.empty();
  // CLI11 would ask for a command before it names a word that it does not know.
  if (wants_command) app.require_subcommand(0, 1);
  keep_unknown_words(app);
  app.set_version_flag("--version", name + " " + ETCM_VERSION, "Print the version and exit");
  try {
    app.parse(argc, argv);
  } catch (const CLI::Success& success) {
    return finish(app, app.exit(success));
  } catch (const CLI::ParseError& error) {
    return complain(app, exit_bad_usage,
                    mistake_of(app, &error) + " (" + name + " --help tells more)");
  }
  if (const std::string mistake = mistake_of(app, nullptr); !mistake.empty()) {
    return complain(app, exit_bad_usage, mistake + " (" + name + " --help tells more)");
  }
  if (wants_command && app.get_subcommands().empty() && !has_positional_argument(app)) {
    return complain(app, exit_bad_usage, "a command is required (" + name + " --help tells more)");
  }
  return std::nullopt;
}

}  // namespace etcm::command_line
