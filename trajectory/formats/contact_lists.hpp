#pragma once
/// \file
/// Contacts of each frame in an H5MD file: lists whose length differs between frames (docs/h5md.md).

#include <cstdint>
#include <string>
#include <vector>

#include "core/hdf5.hpp"

namespace twincell {

/// Writes the contacts of all frames one after the other: `pairs` int32[M][2] (i, j) with bead i < j or j =
/// -1
/// - w for wall w, `values` [M][K], and `count` int64[F], the number of contacts of each frame.
class ContactListWriter {
 public:
  ContactListWriter() = default;
  /// \param value_type file type of `values`
  /// \param each K; 0: it is determined by the first contact, and without any there is no `values`
  ContactListWriter(h5::Handle group, hid_t value_type, std::size_t each = 0);
  [[nodiscard]] explicit operator bool() const { return static_cast<bool>(group_); }
  /// Appends a frame.
  /// \throws RunError if its contacts have a number of values that differs from K
  void append(const std::vector<std::int32_t>& pairs, const std::vector<double>& values);

 private:
  h5::Handle group_;
  hid_t value_type_ = -1;
  h5::Series count_, pairs_, values_;
  std::size_t each_ = 0;  ///< K
};

/// Reads what ContactListWriter writes.
class ContactListReader {
 public:
  ContactListReader() = default;
  /// Opens the group `where` of a file, if it exists.
  /// \throws InputError that names `file_name` if its lists do not fit each other or the numbers of frames
  ContactListReader(hid_t file, std::string where, std::string file_name, std::size_t frames,
                    std::size_t beads);
  [[nodiscard]] explicit operator bool() const { return static_cast<bool>(pairs_); }
  /// K; 0 if no frame has a contact.
  [[nodiscard]] std::size_t values_each() const { return each_; }
  /// Reads one frame.
  /// \throws InputError for a pair that is not a contact of the beads, and for a value that is not finite
  void read(std::size_t frame, std::vector<std::int32_t>& pairs, std::vector<double>& values) const;

 private:
  [[noreturn]] void refuse(const std::string& key, const std::string& complaint) const;

  std::string where_, file_name_;
  std::int64_t beads_ = 0;
  std::size_t each_ = 0;
  h5::Series pairs_, values_;
  std::vector<std::int64_t> count_, begin_;
};

/// Writes the H5MD element /connectivity/contacts: value int32[F][M][2], the pairs of beads in contact in
/// each frame, with -1 in unused entries; M is the largest number of pairs so far. Its attribute
/// particles_group refers to the beads.
class ConnectivityWriter {
 public:
  ConnectivityWriter() = default;
  /// \param particles the group of the beads, whose position/step and position/time are shared
  ConnectivityWriter(hid_t file, const std::string& particles);
  /// Appends the pairs of a frame; contacts with walls are left out.
  void append(const std::vector<std::int32_t>& pairs);

 private:
  h5::Handle value_;
  hsize_t frames_ = 0, most_ = 0;
};

}  // namespace twincell
