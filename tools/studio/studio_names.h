// tools/studio/studio_names.h - names and values that come from a page, checked before any use.
#pragma once

#include <filesystem>
#include <string>

#include "burin/base/files/json_file.h"

namespace burin {

/// A file name made from an upload's: without folders, safe for every file system and web page. Throws Error for a name
/// that ends in none of the extensions of pictures.
std::string upload_name(const std::string& given);

/// A free name in `folder`: name.jpg, name-2.jpg, ...
std::filesystem::path free_name(const std::filesystem::path& folder, const std::string& name);

/// The file `path` below `folder`, links resolved. Throws Error for a path that leads out of it, a hidden file, and
/// anything but a plain file.
std::filesystem::path confined(const std::filesystem::path& folder, const std::string& path);

/// A short text of a request's field, empty if it is absent: letters, digits and " .,:x+_/-". Throws Error otherwise.
std::string plain_value(const Json& json, const std::string& key);

/// A finite number within limits. Throws Error otherwise.
double number_within(const Json& json, const std::string& key, double least, double most);

/// Media type of the files that pages load; empty for all others.
std::string media_type(const std::filesystem::path& file);

/// 24 random bytes of the kernel as 48 hexadecimal digits.
std::string random_token();

/// Compares without a hint by its duration.
bool same_secret(const std::string& a, const std::string& b);

}  // namespace burin
