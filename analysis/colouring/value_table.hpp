#pragma once
/// \file
/// Numbers of the beads from the user's table, by which a drawing colours them.

#include <cstddef>
#include <filesystem>
#include <map>
#include <string>
#include <vector>

namespace twincell::analysis {

/// One number per bead and frame, for those that the table has.
class ValueTable {
 public:
  /// Reads a CSV file with the columns `frame` and `particle`, both counted from 0, and a column of numbers:
  /// `value`, or else the only other one, whose name labels the colour bar.
  ///
  /// \param n_frames, n_beads of the trajectory
  /// \throws InputError as read_table, and for a frame or particle that the trajectory does not have or that
  /// has two rows; ConfigError if a column is missing or if several columns could be the number
  ValueTable(const std::filesystem::path& file, std::size_t n_frames, std::size_t n_beads);

  [[nodiscard]] const std::string& name() const { return name_; }
  /// [n_beads]; NaN for a bead without a number.
  [[nodiscard]] std::vector<double> of(std::size_t frame) const;

 private:
  std::string name_;
  std::size_t n_beads_;
  std::map<std::size_t, std::vector<double>> values_;  ///< by frame
};

}  // namespace twincell::analysis
