#pragma once
/// \file
/// The next step after an error: what a complaint of a reader or of the command line does not know.

#include <CLI/CLI.hpp>
#include <string>
#include <vector>

namespace twincell::cli {

/// A clause for the end of the complaint about a file that begins with one of the words: the nearest name in
/// its folder if the file is missing, or the command that makes what the verb reads. Empty if there is none.
/// \param words the command line without the program: verb, options and files
std::string file_hint(const std::vector<std::string>& words, const std::string& complaint);

/// The complaint of CLI11 with the nearest possible word, the verbs of a group, or the example of the verb.
std::string with_hint(const CLI::App& verb, const std::string& complaint);

/// "run, plan or status"
std::string listed(std::vector<std::string> words);

}  // namespace twincell::cli
