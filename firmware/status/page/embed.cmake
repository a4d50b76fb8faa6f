# Writes OUTPUT, a source with the files of the status page in it (page_files.h), and with those of the
# operating guide, if there are any.
#   cmake -DOUTPUT=page_files.cpp -DFOLDER=firmware/status/page -DFILES=index.html,map.js
#         -DGUIDE=/tmp/guide.html,/tmp/nodes.html -P embed.cmake
string(REPLACE "," ";" files "${FILES}")
string(REPLACE "," ";" guide "${GUIDE}")
set(media_type_html "text/html; charset=utf-8")
set(media_type_css "text/css; charset=utf-8")
set(media_type_js "text/javascript; charset=utf-8")
set(media_type_svg "image/svg+xml")
set(media_type_png "image/png")

set(arrays "")
set(rows "")
set(index 0)
# The file at `source` is served as `path`, and as each path behind that.
macro(embed source path)
  file(READ "${source}" bytes HEX)
  file(SHA256 "${source}" hash)
  if("${path}" STREQUAL "/" AND NOT guide)
    # The lines that lead to the guide.
    file(READ "${source}" text)
    string(REGEX REPLACE "[^\n]*href=\"guide[^\n]*\n" "" text "${text}")
    string(HEX "${text}" bytes)
    string(SHA256 hash "${text}")
  endif()
  string(SUBSTRING "${hash}" 0 15 version)
  string(REGEX REPLACE "(..)" "0x\\1," bytes "${bytes}")
  get_filename_component(extension "${source}" LAST_EXT)
  string(SUBSTRING "${extension}" 1 -1 extension)
  string(APPEND arrays "constexpr unsigned char file_${index}[] = {${bytes}};\n")
  foreach(served IN ITEMS "${path}" ${ARGN})
    string(APPEND rows "    {\"${served}\", \"${media_type_${extension}}\", 0x1${version}u, "
           "{reinterpret_cast<const char*>(file_${index}), sizeof file_${index}}},\n")
  endforeach()
  math(EXPR index "${index} + 1")
endmacro()

foreach(file IN LISTS files)
  if(file STREQUAL "index.html")
    embed("${FOLDER}/${file}" "/")
  else()
    embed("${FOLDER}/${file}" "/${file}")
  endif()
endforeach()
foreach(file IN LISTS guide)
  get_filename_component(name "${file}" NAME)
  if(name STREQUAL "guide.html")
    embed("${file}" "/guide")
  elseif(name STREQUAL "README.html")
    # Who adds a slash finds the same, with links that are right there.
    embed("${file}" "/guide/README.html" "/guide/")
  else()
    embed("${file}" "/guide/${name}")
  endif()
endforeach()

file(WRITE "${OUTPUT}" "#include \"firmware/status/page_files.h\"

namespace etcm::firmware {

namespace {

${arrays}
}  // namespace

std::span<const PageFile> page_files() {
  static const PageFile files[] = {
${rows}  };
  return files;
}

}  // namespace etcm::firmware
")
