# Run by burin_embed() at build time: FILES (parted by |) as string literals into OUT, which defines burin::embedded::NAME().
string(REPLACE "|" ";" FILES "${FILES}")
set(cases "")
foreach(path IN LISTS FILES)
  get_filename_component(file "${path}" NAME)
  file(READ "${path}" text)
  string(FIND "${text}" ")burin_file\"" at)
  if(NOT at EQUAL -1)
    message(FATAL_ERROR "${path} contains )burin_file\", which ends the literal that it is embedded as: write it otherwise")
  endif()
  string(APPEND cases "  if (file == \"${file}\")\n    return R\"burin_file(${text})burin_file\"sv;\n")
endforeach()
file(WRITE "${OUT}" "// Made by cmake/burin_embed.cmake; edit the files that are embedded.
#include \"embedded/${NAME}.h\"

#include <stdexcept>
#include <string>

namespace burin::embedded {

std::string_view ${NAME}(std::string_view file) {
  using namespace std::string_view_literals;
${cases}  throw std::logic_error(\"embedded::${NAME}: there is no \" + std::string(file));
}

}  // namespace burin::embedded
")
