#include "firmware/app/control_client.h"

#include <sys/socket.h>
#include <sys/un.h>

#include <algorithm>
#include <array>
#include <cerrno>
#include <cstdio>
#include <cstring>
#include <memory>
#include <string_view>
#include <utility>
#include <vector>

#include "firmware/app/support_bundle.h"
#include "firmware/control/shown_names.h"
#include "firmware/toml/likeliest_word.h"
#include "posix/file_descriptor.h"

namespace etcm::firmware {

namespace {

constexpr std::array<std::string_view, 5> commands = {"list", "dismiss", "acknowledge", "show",
                                                      "bundle"};

// A gateway that does not answer for longer hangs.
constexpr timeval answer_patience{.tv_sec = 10, .tv_usec = 0};

std::string failure_of(const std::string& socket, int error) {
  std::string why = socket + ": " + std::strerror(error) + "; ";
  switch (error) {
    case EACCES:
      return why + "only root and the user of the gateway may tell it something: sudo";
    case ENOENT:
    case ECONNREFUSED:
      return why +
             "no gateway listens there: start it (systemctl start etcm-gateway; one that failed "
             "starts again by itself within 5 s), or give its `socket` of [control] with --socket";
    case EAGAIN:
      return why + "the gateway does not answer: systemctl status etcm-gateway";
    default:
      return why + "give the `socket` of [control] of a gateway that runs with --socket";
  }
}

bool send_all(int descriptor, std::string_view text) {
  while (!text.empty()) {
    const ssize_t sent = ::send(descriptor, text.data(), text.size(), MSG_NOSIGNAL);
    if (sent < 0 && errno == EINTR) continue;
    if (sent < 0) return false;
    text.remove_prefix(static_cast<std::size_t>(sent));
  }
  return true;
}

// Takes the first line of an answer off it.
class AnswerReader {
 public:
  explicit AnswerReader(const std::function<void(std::string_view)>& take) : take_(take) {}

  void hear(std::string_view text) {
    if (!is_head_over_) {
      const std::size_t end = text.find('\n');
      head_.append(text.substr(0, end));
      if (end == std::string_view::npos) return;
      is_head_over_ = true;
      text.remove_prefix(end + 1);
    }
    if (!text.empty()) take_(text);
  }

  std::string mistake() const {
    if (head_ == "ok") return {};
    if (head_.starts_with("error ")) return head_.substr(6);
    return "what answers there is no gateway of this version";
  }

 private:
  const std::function<void(std::string_view)>& take_;
  std::string head_;
  bool is_head_over_ = false;
};

void print(std::string_view text) { std::fwrite(text.data(), 1, text.size(), stdout); }

// Each line; ends at the first that goes wrong.
int tell(const std::string& socket, const std::vector<std::string>& lines) {
  for (const std::string& line : lines) {
    const std::string mistake = ask_gateway(socket, line, print);
    if (mistake.empty()) continue;
    std::fprintf(stderr, "etcm-gateway: %s\n", mistake.c_str());
    return 1;
  }
  return 0;
}

std::vector<std::string> lines_of(const std::string& command,
                                  const std::vector<std::string>& words) {
  std::vector<std::string> lines;
  lines.reserve(words.size());
  for (const std::string& word : words) lines.push_back(command + " " + word);
  return lines;
}

struct ControlOptions {
  std::string socket = control_socket_default;
  bool wants_all = false;
  bool wants_json = false;
  std::vector<std::string> words;
  BundleOptions bundle;
};

template <class Words>
std::string list_of(const Words& words) {
  std::string list;
  for (const std::string_view word : words) list += (list.empty() ? "" : ", ") + std::string(word);
  return list;
}

template <class Words>
std::string unknown_word(const std::string& command, const std::string& typed, const Words& words) {
  const std::string_view meant = likeliest_word({words.begin(), words.end()}, typed);
  return command + ": there is no '" + typed + "'; " +
         (meant.empty() ? "there are " : "did you mean '" + std::string(meant) + "'? There are ") +
         list_of(words);
}

// The option of a command that a word of the line is meant to be; empty: none.
std::string option_meant(const CLI::App& command, const std::string& typed) {
  std::vector<std::string> names;
  for (const CLI::Option* const option : command.get_options()) {
    for (const std::string& name : option->get_lnames()) names.push_back("--" + name);
  }
  return std::string(likeliest_word({names.begin(), names.end()}, typed));
}

// Says which word of the line means nothing, and which was meant.
void check_command(const CLI::App& ctl) {
  const std::vector<std::string> unknown = ctl.remaining(true);
  const std::vector<CLI::App*> given = ctl.get_subcommands();
  if (given.size() == 1 && unknown.empty()) return;
  const auto fail = [](const std::string& what) {
    throw CLI::ParseError(what, CLI::ExitCodes::ExtrasError);
  };
  if (given.empty() && unknown.empty()) {
    fail("ctl: it is not said what to do; add one of " + list_of(commands));
  }
  if (given.empty()) fail(unknown_word("ctl", unknown.front(), commands));
  if (unknown.empty()) fail("ctl: one command at a time; give them one by one");
  const std::string meant = option_meant(*given.front(), unknown.front());
  fail("ctl " + given.front()->get_name() + ": '" + unknown.front() + "' means nothing here; " +
       (meant.empty() ? "take it out" : "did you mean '" + meant + "'?"));
}

void check_shown(const std::vector<std::string>& words) {
  for (const std::string& word : words) {
    if (std::find(shown_names.begin(), shown_names.end(), word) != shown_names.end()) continue;
    throw CLI::ParseError(unknown_word("ctl show", word, shown_names),
                          CLI::ExitCodes::ValidationError);
  }
}

// Where what can be named is seen.
std::string which_hint(std::string_view command) {
  if (command == "show") return "";
  return ", as sudo etcm-gateway ctl list shows them";
}

// No word of a command line is two lines to the gateway.
std::string check_word(const std::string& word) {
  const bool is_one = !word.empty() && word.find('\n') == std::string::npos;
  return is_one ? "" : "'" + word + "' is no serial, name or number";
}

}  // namespace

std::string ask_gateway(const std::string& socket, const std::string& line,
                        const std::function<void(std::string_view)>& take) {
  sockaddr_un address{};
  address.sun_family = AF_UNIX;
  if (socket.size() >= sizeof(address.sun_path)) return failure_of(socket, ENAMETOOLONG);
  std::memcpy(address.sun_path, socket.c_str(), socket.size() + 1);
  const port::FileDescriptor stream(::socket(AF_UNIX, SOCK_STREAM | SOCK_CLOEXEC, 0));
  if (!stream.is_open()) return failure_of(socket, errno);
  for (const int option : {SO_RCVTIMEO, SO_SNDTIMEO}) {
    ::setsockopt(stream.get(), SOL_SOCKET, option, &answer_patience, sizeof(answer_patience));
  }
  if (::connect(stream.get(), reinterpret_cast<const sockaddr*>(&address), sizeof(address)) != 0 ||
      !send_all(stream.get(), line + "\n")) {
    return failure_of(socket, errno);
  }
  AnswerReader answer(take);
  std::array<char, 65536> buffer;
  while (true) {
    const ssize_t count = ::recv(stream.get(), buffer.data(), buffer.size(), 0);
    if (count < 0 && errno == EINTR) continue;
    if (count < 0) return failure_of(socket, errno);
    if (count == 0) return answer.mistake();
    answer.hear({buffer.data(), static_cast<std::size_t>(count)});
  }
}

void add_control_command(CLI::App& app, std::function<int()>& run) {
  const auto options = std::make_shared<ControlOptions>();
  CLI::App* const ctl = app.add_subcommand(
      "ctl", "tell the gateway that runs on this machine something (sudo etcm-gateway ctl list)");
  // What is wrong with the line is said here, by the words that are wrong.
  ctl->allow_extras();
  ctl->parse_complete_callback([ctl] { check_command(*ctl); });
  ctl->add_option("--socket", options->socket, "where it listens")->capture_default_str();

  CLI::App* const list = ctl->add_subcommand("list", "the alarms: what is wrong, since when");
  list->add_flag("--all", options->wants_all, "those that have ended too");
  list->add_flag("--json", options->wants_json, "as JSON");
  list->callback([options, &run] {
    run = [options] {
      const std::string kind = options->wants_all ? "show history" : "show alarms";
      return tell(options->socket, {kind + (options->wants_json ? ".json" : "")});
    };
  });

  const auto add_words = [&](const char* name, const char* what, const std::string& words) {
    CLI::App* const command = ctl->add_subcommand(name, what);
    command->add_option("what", options->words, words)->check(check_word);
    command->callback([options, &run, name, words] {
      if (options->words.empty()) {
        throw CLI::ParseError(
            std::string("ctl ") + name + ": it is not said which; add " + words + which_hint(name),
            CLI::ExitCodes::RequiredError);
      }
      if (std::string_view(name) == "show") check_shown(options->words);
      run = [options, name] { return tell(options->socket, lines_of(name, options->words)); };
    });
  };
  add_words("dismiss", "wait no longer for nodes that are missing, or gateways that are gone",
            "serials, names of nodes or gateways, or all");
  add_words("acknowledge", "say that somebody knows of alarms", "their numbers, or all");
  add_words("show", "print what the gateway says of itself", "one of " + list_of(shown_names));

  CLI::App* const bundle = ctl->add_subcommand(
      "bundle", "pack what helps to find a fault: settings, state, log, figures, versions");
  bundle->add_option("-o,--output", options->bundle.output,
                     "the archive, a .tar.gz; default: etcm-"
                     "bundle-DATE.tar.gz");
  bundle->add_option("--config", options->bundle.config,
                     "the settings; default: those of the gateway that runs");
  bundle->callback([options, &run] {
    run = [options] { return make_bundle(options->socket, options->bundle); };
  });
}

}  // namespace etcm::firmware
