#pragma once
/// \file
/// What H5MD files of other programs leave to their reader: rows that change their beads from frame to frame
/// (`id`), and positions that are wrapped into a period, with the number of periods (`image`) or without.
/// Source: de Buyl, Colberg & Höfling 2014, "H5MD: a structured, efficient, and portable file format for
/// molecular data", and the specification 1.1 at nongnu.org/h5md.

#include <cstddef>
#include <cstdint>
#include <string>
#include <unordered_map>
#include <vector>

#include "core/hdf5.hpp"
#include "trajectory/box.hpp"
#include "trajectory/trajectory.hpp"

namespace twincell {

/// Gives frames of another program the order of the beads in the first frame, and positions that go on across
/// periods.
class ForeignRows {
 public:
  ForeignRows() = default;
  /// Reads all ids, and all positions if they may be wrapped without a number of periods; these are unwrapped
  /// by the rule of wrapped_positions.hpp.
  /// \param group the group of the particles
  /// \param id, position its columns, which outlive this; `id` may be absent
  /// \throws InputError naming `file` if a frame names a bead twice, if more beads occur than a frame has
  /// rows, or if images have another shape than positions
  ForeignRows(hid_t group, const h5::Series& id, const h5::Series& position, const Box& box,
              std::size_t n_beads, const std::string& file);
  /// Changes a frame from the file's rows and positions.
  /// \param index its number
  void restore(std::size_t index, Frame& frame) const;

 private:
  /// A bead crossed the end of a period in the step to this frame.
  struct Crossing {
    std::size_t frame, bead;
    int axis;
    double periods;  ///< that the bead has crossed so far
  };
  void find_slots(const h5::Series& id, std::size_t n_beads, const std::string& file);
  void order(Frame& frame) const;
  void find_crossings(const h5::Series& id, const h5::Series& position, std::size_t n_beads);

  Box box_;
  h5::Series images_;
  std::unordered_map<std::int64_t, std::size_t> slot_of_;  ///< by id; empty: rows keep their beads
  std::vector<Crossing> crossings_;                        ///< by frame
};

}  // namespace twincell
