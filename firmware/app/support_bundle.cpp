#include "firmware/app/support_bundle.h"

#include <fcntl.h>
#include <spawn.h>
#include <sys/utsname.h>
#include <sys/wait.h>
#include <unistd.h>

#include <cerrno>
#include <chrono>
#include <cstdio>
#include <cstring>
#include <ctime>
#include <filesystem>
#include <fstream>
#include <system_error>
#include <vector>

#include "firmware/app/control_client.h"
#include "firmware/config/settings.h"

extern char** environ;

namespace etcm::firmware {

namespace {

namespace fs = std::filesystem;

// Runs it with all that it says in `file`, where one is given. Returns what went wrong, or empty.
std::string run_program(const std::vector<std::string>& words, const fs::path& file = {}) {
  std::vector<char*> arguments;
  arguments.reserve(words.size() + 1);
  for (const std::string& word : words) arguments.push_back(const_cast<char*>(word.c_str()));
  arguments.push_back(nullptr);
  posix_spawn_file_actions_t actions;
  posix_spawn_file_actions_init(&actions);
  posix_spawn_file_actions_addopen(&actions, STDIN_FILENO, "/dev/null", O_RDONLY, 0);
  if (!file.empty()) {
    posix_spawn_file_actions_addopen(&actions, STDOUT_FILENO, file.c_str(),
                                     O_WRONLY | O_CREAT | O_TRUNC, 0600);
    posix_spawn_file_actions_adddup2(&actions, STDOUT_FILENO, STDERR_FILENO);
  }
  pid_t child = 0;
  const int error =
      ::posix_spawnp(&child, arguments[0], &actions, nullptr, arguments.data(), environ);
  posix_spawn_file_actions_destroy(&actions);
  if (error != 0) return words[0] + ": " + std::strerror(error);
  int state = 0;
  while (::waitpid(child, &state, 0) < 0 && errno == EINTR) {
  }
  if (WIFEXITED(state) && WEXITSTATUS(state) == 0) return {};
  return words[0] + " failed";
}

// The folder that is packed, and what could not be had.
class Bundle {
 public:
  explicit Bundle(fs::path folder) : folder_(std::move(folder)) {}

  void note(const std::string& what, const std::string& why) {
    if (!why.empty()) missing_ += what + ": " + why + "\n";
  }

  // A file, or all regular files of a folder.
  void copy(const fs::path& from, const fs::path& to) {
    std::error_code error;
    fs::create_directories((folder_ / to).parent_path(), error);
    fs::copy(from, folder_ / to, fs::copy_options::recursive, error);
    if (error) note(from, error.message());
  }

  // One that does not answer is not waited for again.
  void ask(const std::string& socket, const std::string& what, const std::string& name) {
    std::ofstream file(folder_ / name, std::ios::binary);
    if (silence_.empty()) {
      silence_ =
          ask_gateway(socket, "show " + what, [&file](std::string_view text) { file << text; });
    }
    note(name, silence_);
  }

  bool is_answered() const { return silence_.empty(); }

  void write(const std::string& name, const std::string& text) {
    std::ofstream(folder_ / name, std::ios::binary) << text;
  }

  void write_missing() {
    if (!missing_.empty()) write("what-is-missing", missing_);
  }

 private:
  const fs::path folder_;
  std::string silence_;  // why the gateway is not asked
  std::string missing_;
};

std::string versions() {
  utsname system{};
  ::uname(&system);
  return std::string("etcm-gateway ") + ETCM_VERSION + "\n" + system.sysname + " " +
         system.release + " " + system.version + " " + system.machine + "\n";
}

// Settings name files with secrets, and have none themselves.
void copy_settings(Bundle& bundle, const std::string& config) {
  bundle.copy(config, fs::path("settings") / fs::path(config).filename());
  std::vector<std::string> mistakes;
  const Settings settings = read_settings(config, mistakes);
  std::string all;
  for (const std::string& mistake : mistakes) all += mistake + "\n";
  bundle.note("settings", all);
  if (!settings.site.path.empty()) {
    bundle.copy(settings.site.path, fs::path("settings") / fs::path(settings.site.path).filename());
  }
  for (const std::string& profiles : settings.profiles) {
    bundle.copy(profiles, fs::path("settings") / fs::path(profiles).filename());
  }
  if (settings.state) bundle.copy(settings.state->folder, "state");
}

std::string name_of_now() {
  const std::time_t now = std::time(nullptr);
  std::tm broken{};
  ::gmtime_r(&now, &broken);
  char text[32];
  const std::size_t size = std::strftime(text, sizeof(text), "%Y%m%dT%H%M%SZ", &broken);
  return "etcm-bundle-" + std::string(text, size);
}

int complain(const std::string& what) {
  std::fprintf(stderr, "etcm-gateway: %s\n", what.c_str());
  return 1;
}

// The settings of the gateway that runs, or those that are installed.
std::string config_of(const std::string& socket, const Bundle& bundle) {
  std::string config;
  const bool is_told =
      bundle.is_answered() && ask_gateway(socket, "show config", [&config](std::string_view text) {
                                config += text;
                              }).empty();
  return is_told ? config.substr(0, config.find('\n')) : "/etc/etcm/gateway.toml";
}

}  // namespace

int make_bundle(const std::string& socket, const BundleOptions& options) {
  const std::string name = name_of_now();
  std::error_code error;
  const fs::path temporary = fs::temp_directory_path(error);
  std::string place = (temporary / "etcm-bundle-XXXXXX").string();
  if (error) return complain("TMPDIR is no folder; set it to one with room");
  if (::mkdtemp(place.data()) == nullptr) {
    return complain(place + ": " + std::strerror(errno) + "; set TMPDIR to a folder with room");
  }
  const fs::path folder = fs::path(place) / name;
  fs::create_directory(folder);
  Bundle bundle(folder);
  for (const char* what :
       {"history.json", "status.json", "units.json", "features.json", "metrics", "health"}) {
    bundle.ask(socket, what, what);
  }
  bundle.ask(socket, "history", "alarms");
  copy_settings(bundle, options.config.empty() ? config_of(socket, bundle) : options.config);
  bundle.note("log", run_program({"journalctl", "-u", "etcm-gateway", "--no-pager", "-o",
                                  "short-iso", "-n", "50000"},
                                 folder / "log"));
  // Of a service that wrote nothing there journalctl says so in a line, and nothing went wrong.
  if (fs::file_size(folder / "log", error) < 100) {
    bundle.note("log",
                "the journal has nothing of the service; a gateway that was started by hand "
                "writes to its standard error");
  }
  bundle.write("versions", versions());
  bundle.copy("/etc/os-release", "os-release");
  bundle.write_missing();
  const std::string output = options.output.empty() ? name + ".tar.gz" : options.output;
  const std::string failure = run_program({"tar", "-czf", output, "-C", place, name});
  fs::remove_all(place);
  if (!failure.empty()) return complain(output + ": cannot be written: " + failure);
  std::printf(
      "%s\nIt has settings, state, log, alarms and figures, but no passwords and no keys; "
      "look at it before you send it.\n",
      output.c_str());
  return 0;
}

}  // namespace etcm::firmware
