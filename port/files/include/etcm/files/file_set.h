// Several files that appear together, or not at all.
#pragma once

#include <string>
#include <string_view>
#include <vector>

namespace etcm::files {

// Collects the contents of files, then writes them all to temporary files in the folders of their
// targets, syncs them, and only then renames. A failure before the first rename changes nothing.
// Signals that would end the program wait until the files are in place.
class FileSet {
 public:
  // A target that exists and is no regular file (a pipe, a terminal) is written to directly; a
  // symbolic link is followed. "-" is the standard output.
  void add(std::string path, std::string contents);

  // Throws OutputError and leaves no temporary file. Call once.
  void commit();

  std::size_t bytes() const;
  const std::string& path(std::size_t index) const { return files_[index].path; }
  std::size_t size() const { return files_.size(); }

 private:
  struct File {
    std::string path;
    std::string contents;
    std::string target;     // path, links followed
    std::string temporary;  // empty where it is written directly
  };
  void write_temporaries();
  void rename_all();
  void remove_temporaries() noexcept;

  std::vector<File> files_;
};

// Writes all of it, or throws OutputError naming `name`.
void write_all(int descriptor, std::string_view text, const std::string& name);

}  // namespace etcm::files
