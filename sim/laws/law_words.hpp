#pragma once
/// \file
/// The contact laws by their words, for scenes and messages: the words of each axis, the keys that a law
/// reads, and the check of its parameters. It does not include the laws, so that a change in one of them
/// compiles only what evaluates it.

#include <string>
#include <vector>

#include "sim/laws/parameters.hpp"

namespace twincell::sim {

/// Checks that a table contains valid parameters for the named laws.
/// \throws ConfigError
void check_laws(const std::string& normal, const std::string& tangential, const std::string& rolling,
                const ContactTable& table);

/// The words of the normal laws, in the order of axes.hpp, for scenes and messages.
std::vector<std::string> normal_words();
/// The words of the tangential laws.
std::vector<std::string> tangential_words();
/// The words of the rolling laws.
std::vector<std::string> rolling_words();
/// What the normal laws are: "linear: spring and dashpot, ...; hertz: ...", as help_of() of core/choice.hpp.
std::string normal_help();
/// What the tangential laws are.
std::string tangential_help();
/// What the rolling laws are.
std::string rolling_help();
/// Whether the named tangential law has a spring with history.
bool has_history(const std::string& tangential);
/// Whether the named tangential law reads a key.
bool tangential_reads(const std::string& tangential, const std::string& key);
/// The word of the law to choose instead of the named tangential law for a force without history; the law
/// itself if it has none.
std::string law_without_history(const std::string& tangential);
/// The keys that the named laws read.
std::vector<std::string> keys_of(const std::string& normal, const std::string& tangential,
                                 const std::string& rolling);
/// The keys of all laws.
std::vector<std::string> all_law_keys();
/// The axis to which a key belongs ("normal", for example), and the words of the laws that read it.
struct KeyReaders {
  std::string axis;
  std::vector<std::string> laws;
};
/// The readers of a key of all_law_keys(). Both members are empty for another key.
KeyReaders readers_of(const std::string& key);

}  // namespace twincell::sim
