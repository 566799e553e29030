// burin/base/files/file_names.h - names of views, lamps and the like, in any script, as names of files.
#pragma once

#include <filesystem>
#include <string>
#include <string_view>
#include <vector>

namespace burin {

/// A name that any file system takes: letters of all languages, digits, "-", "_" and "." stay, whatever else is "_"
/// (blanks, slashes, bytes that are no UTF-8); no dot or dash in front; at most 100 bytes, cut between letters. Two
/// names may become one: distinct_file_names().
std::string file_name_of(std::string_view name);

/// One name of a file for each, all different even where capitals and small letters are one (vfat, macOS): a second
/// "a_b" is "a_b-2". With each of `endings` behind it, too: a view "left" that writes left.png and left-start.png takes
/// both names from a view "left-start".
std::vector<std::string> distinct_file_names(const std::vector<std::string>& names,
                                             const std::vector<std::string>& endings = {});

/// Capital letters of ASCII as small ones: ".JPG" is ".jpg".
std::string lower_case(std::string text);

/// A file's extension with its dot, in small letters: what kind of file its name says that it is.
std::string lower_extension(const std::filesystem::path& file);

}  // namespace burin
