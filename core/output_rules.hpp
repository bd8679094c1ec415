#pragma once
/// \file
/// What an output may replace; the rules are the same for all verbs (docs/running.md, "Where output goes").
///
/// An existing file is replaced if it is a product of the same kind, or with --force. A folder is written to
/// if it is absent, empty, or has a manifest of the same product. In it, only files that the manifest lists
/// and that are unchanged are replaced. Inputs and anything that is not a regular file are never replaced.

#include <filesystem>
#include <string>
#include <vector>

#include "core/output_kind.hpp"

namespace twincell {

/// Prefix of the names of all temporary files: unfinished outputs and locks.
inline constexpr const char* kTemporaryPrefix = ".twincell-";

/// Registers a file or folder as an input. No output replaces it, and no output folder may contain it. A file
/// in an input folder is replaced only if it is a product of the output's kind, also with --force. Paths that
/// do not exist are ignored. Thread-safe.
void protect_input(const std::filesystem::path& path);

/// Allows an output to replace an existing regular file of any kind (--force), unless it is an input.
/// Messages advise --force once this has been called: a program without that option, such as the Python
/// module, does not.
void replace_by_force(bool allowed);

/// Output name that stands for standard output, for products that are a single text file. `./-` is a file of
/// that name.
inline constexpr const char* kStandardOutput = "-";

/// Path that an output is written to: absolute, with links and ".." resolved, or kStandardOutput.
/// \throws ConfigError naming the output and the obstacle, before anything is written
std::filesystem::path require_output(const std::filesystem::path& path, const Product& product);

/// Whether `product` may replace an existing file: one of the same kind, or any with --force.
bool may_replace(const std::filesystem::path& file, const Product& product);

/// Creates a folder that several runs share, with its manifest, or accepts an existing one.
/// \returns as require_output
/// \throws ConfigError as require_output, or if the folder cannot be created
std::filesystem::path claim_shared_folder(const std::filesystem::path& path, const Product& product);

/// Takes all files off the list of a shared folder, so that this run may replace them. A run that is killed
/// leaves files without a hash, which the next one judges by their kind.
/// \throws ConfigError naming a listed file that has changed since it was written
void unlist_files(const std::filesystem::path& folder);

/// Lists finished files of a shared folder with their hashes.
/// \param names in the folder
void list_files(const std::filesystem::path& folder, const std::vector<std::string>& names);

}  // namespace twincell
