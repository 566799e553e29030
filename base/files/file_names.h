// burin/base/files/file_names.h - file names from names of views, lamps and the like, in any script.
#pragma once

#include <filesystem>
#include <string>
#include <string_view>
#include <vector>

namespace burin {

/// A name for any file system. Letters of all languages, digits, "-", "_" and "." remain; other characters (blanks,
/// slashes, invalid UTF-8) become "_". It has no dot or dash in front and at most 100 bytes, cut between letters. Two
/// names may become one: see distinct_file_names().
std::string file_name_of(std::string_view name);

/// One file name per name, all different even if the file system ignores case (vfat, macOS): a second "a_b" becomes
/// "a_b-2". They also differ with each of `endings` appended: a view "left" with left.png and left-start.png reserves
/// both names, so a view "left-start" gets another.
std::vector<std::string> distinct_file_names(const std::vector<std::string>& names,
                                             const std::vector<std::string>& endings = {});

/// Converts ASCII capitals to small letters: ".JPG" becomes ".jpg".
std::string lower_case(std::string text);

/// A file's extension with its dot, in small letters: the kind of file by its name.
std::string lower_extension(const std::filesystem::path& file);

}  // namespace burin
