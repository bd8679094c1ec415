#pragma once
/// \file
/// What an output may replace: one rule for all verbs (docs/running.md, "Where output goes").
///
/// A file that exists is replaced if it is a product of the same kind, or with --force. A folder is written
/// into if it is absent, empty, or has a manifest of the same product; of what lies in it only files that the
/// manifest lists and that are unchanged are replaced. An input is never replaced, nor is anything but a
/// regular file.

#include <filesystem>
#include <string>

#include "core/output_kind.hpp"

namespace twincell {

/// Names of everything temporary begin with this: unfinished outputs, locks.
inline constexpr const char* kTemporaryPrefix = ".twincell-";

/// Notes that the program reads a file or folder: no output replaces it or anything in it. Names of what does
/// not exist are ignored. Safe to call from several threads.
void protect_input(const std::filesystem::path& path);

/// With --force one existing regular file may be of any kind, unless it is an input.
void replace_by_force(bool allowed);

/// The output that is standard output, for products that are text in one file. A file of that name is `./-`.
inline constexpr const char* kStandardOutput = "-";

/// Where an output goes: absolute, links and ".." resolved, or kStandardOutput.
/// \throws ConfigError naming the output and what is in its way, before anything has been written
std::filesystem::path require_output(const std::filesystem::path& path, const Product& product);

/// Whether a file that exists may be replaced by a product.
bool may_replace(const std::filesystem::path& file, const Product& product);

/// Makes a folder that several runs share, with its manifest, or accepts it if it is there.
/// \return as require_output \throws ConfigError as it does, or if the folder cannot be made
std::filesystem::path claim_shared_folder(const std::filesystem::path& path, const Product& product);

}  // namespace twincell
