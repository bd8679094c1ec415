#pragma once
/// \file
/// The option --profile: where the time of a verb went.

#include <cstdint>
#include <nlohmann/json.hpp>
#include <string>
#include <vector>

#include "core/cpu_clock.hpp"
#include "core/stage_times.hpp"

namespace CLI {
class App;
}

namespace twincell::cli {

/// Times the stages of a verb if the user asks for it.
///
///     Profile profile(options.profile);
///     { Stage writing(profile.times(), "writing", "frames"); … }
///     profile.add_to(document, text, threads);
///     print_result(common, document, text);
class Profile {
 public:
  /// The time starts now.
  explicit Profile(bool wanted) : wanted_(wanted) {}
  /// For functions that time their stages; null if no profile is wanted.
  [[nodiscard]] StageTimes* times() { return wanted_ ? &times_ : nullptr; }
  /// For functions that sum the stages of several threads, each of which did its own work; null if no profile
  /// is wanted. The sum then takes the place of times(): its total is the time of all these threads.
  [[nodiscard]] std::vector<StageTimes::Row>* sum() { return wanted_ ? &sum_ : nullptr; }
  /// A number that explains the times, such as visited pairs. Printed below the table.
  void state(const std::string& name, std::int64_t value);
  /// Adds the key "profile" to the document and the table to the text. Does nothing if no profile is wanted.
  /// Measures the bandwidth of memory if a stage counted bytes.
  /// \param threads that the verb used
  void add_to(nlohmann::json& document, std::string& text, int threads) const;

 private:
  bool wanted_;
  StageTimes times_;
  std::vector<StageTimes::Row> sum_;
  double processor_ = process_cpu_seconds();
  nlohmann::ordered_json counters_ = nlohmann::ordered_json::object();
};

/// Adds the option to a verb.
void add_profile_option(CLI::App& verb, bool& profile);

}  // namespace twincell::cli
