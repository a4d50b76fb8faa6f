// Runs something in a process that is killed at one of its system calls, so that a test can look at
// what every moment of it leaves behind.
#pragma once

#include <linux/filter.h>
#include <linux/seccomp.h>
#include <sys/prctl.h>
#include <sys/ptrace.h>
#include <sys/syscall.h>
#include <sys/wait.h>
#include <unistd.h>

#include <cerrno>
#include <csignal>
#include <cstddef>
#include <functional>
#include <vector>

namespace etcm::test {

inline constexpr unsigned long to_the_end = ~0ul;

struct Traced {
  bool can_trace = true;    // false under an emulator
  unsigned long stops = 0;  // before and after each system call
  std::vector<long> calls;  // the numbers of the system calls
  bool was_killed = false;
};

// Runs `action` in a process that is killed at the given stop, before the call there is done or
// after it.
inline Traced run_killed_at(unsigned long kill_at, const std::function<void()>& action) {
  Traced traced;
  const pid_t child = ::fork();
  if (child == 0) {
    if (::ptrace(PTRACE_TRACEME, 0, nullptr, nullptr) != 0) ::_exit(99);
    ::raise(SIGSTOP);
    action();
    ::_exit(0);
  }
  int status = 0;
  ::waitpid(child, &status, 0);
  if (WIFEXITED(status)) {
    traced.can_trace = false;
    return traced;
  }
  ::ptrace(PTRACE_SETOPTIONS, child, nullptr, PTRACE_O_EXITKILL | PTRACE_O_TRACESYSGOOD);
  for (;;) {
    if (traced.stops == kill_at) {
      ::kill(child, SIGKILL);
      traced.was_killed = true;
    }
    ::ptrace(PTRACE_SYSCALL, child, nullptr, nullptr);
    ::waitpid(child, &status, 0);
    if (WIFEXITED(status) || WIFSIGNALED(status)) return traced;
    if (WSTOPSIG(status) != (SIGTRAP | 0x80)) continue;
    ++traced.stops;
    __ptrace_syscall_info info{};
    ::ptrace(PTRACE_GET_SYSCALL_INFO, child, sizeof info, &info);
    if (info.op == PTRACE_SYSCALL_INFO_ENTRY)
      traced.calls.push_back(static_cast<long>(info.entry.nr));
  }
}

// From now on this process gets `error` for the system call with this number. False where the
// system cannot do that. Only in a process of its own: nothing takes it back.
inline bool forbid_call(long call, int error) {
  sock_filter steps[] = {
      BPF_STMT(BPF_LD | BPF_W | BPF_ABS, offsetof(seccomp_data, nr)),
      BPF_JUMP(BPF_JMP | BPF_JEQ | BPF_K, static_cast<unsigned>(call), 0, 1),
      BPF_STMT(BPF_RET | BPF_K, SECCOMP_RET_ERRNO | static_cast<unsigned>(error)),
      BPF_STMT(BPF_RET | BPF_K, SECCOMP_RET_ALLOW),
  };
  const sock_fprog program{.len = sizeof steps / sizeof steps[0], .filter = steps};
  return ::prctl(PR_SET_NO_NEW_PRIVS, 1, 0, 0, 0) == 0 &&
         ::prctl(PR_SET_SECCOMP, SECCOMP_MODE_FILTER, &program) == 0;
}

}  // namespace etcm::test
