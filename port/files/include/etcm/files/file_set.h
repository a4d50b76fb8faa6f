// Several files that appear together, or not at all.
#pragma once

#include <functional>
#include <string>
#include <vector>

#include "etcm/files/text_sink.h"

namespace etcm::files {

// Collects what is to stand in files, then writes them all to temporary files in the folders of
// their targets, syncs them, and only then renames. A failure before the first rename changes
// nothing. Signals that would end the program wait until the files are in place.
class FileSet {
 public:
  FileSet();

  // A target that exists and is no regular file (a pipe, a terminal) is written to directly; a
  // symbolic link is followed. "-" is the standard output. `write` is called by each commit, as
  // often as needed.
  void add(std::string path, std::function<void(TextSink&)> write);
  void add(std::string path, std::string contents);

  struct Failure {
    const std::string* path = nullptr;  // null: nothing failed
    int error = 0;                      // of errno
  };
  // Leaves no temporary file where it fails. May be called again; that takes no memory, as long as
  // no link leads to a longer path than before.
  Failure try_commit();

  // The same, but throws OutputError.
  void commit();

  // Removes temporary files of these targets that a process left behind which was killed while it
  // wrote. REQUIRES: no other one writes these targets now.
  void remove_leftovers();

 private:
  struct File {
    std::string path;
    std::function<void(TextSink&)> write;
    std::string target;     // path, links followed; empty where it is written directly
    std::string temporary;  // empty while there is none
  };
  Failure write_temporary(File& file);
  Failure rename_all();
  Failure write_directly(const File& file);
  int write(int descriptor, const File& file);
  void remove_temporaries();

  std::vector<File> files_;
  std::vector<char> buffer_;
};

}  // namespace etcm::files
