#pragma once
/// \file
/// The HDF5 C API behind handles that close themselves and calls that check themselves.

#include <hdf5.h>

#include <cstdint>
#include <string>
#include <utility>
#include <vector>

namespace twincell::h5 {

/// An HDF5 identifier of any kind; closes itself.
class Handle {
 public:
  Handle() = default;
  explicit Handle(hid_t id) : id_(id) {}
  Handle(Handle&& other) noexcept : id_(std::exchange(other.id_, -1)) {}
  Handle& operator=(Handle&& other) noexcept {
    std::swap(id_, other.id_);
    return *this;
  }
  Handle(const Handle&) = delete;
  Handle& operator=(const Handle&) = delete;
  ~Handle();
  [[nodiscard]] hid_t get() const { return id_; }
  [[nodiscard]] explicit operator bool() const { return id_ >= 0; }
  void reset();

 private:
  hid_t id_ = -1;
};

/// Wraps a fresh identifier. \throws RunError "`what` failed: HDF5's own reason" if it is negative
Handle own(hid_t id, const std::string& what);
/// \throws RunError likewise if `status` is negative
void check(herr_t status, const std::string& what);
/// Turns off HDF5's own printing; the reason goes into our sentences. And its own tidying at the exit, if
/// called before anything else of HDF5. Called by each function that opens a file.
void quiet();

/// Native memory type of T: double, int, std::int64_t, std::uint8_t, std::int8_t.
template <class T>
hid_t native();

Handle create_group(hid_t parent, const std::string& name);
/// True if `path` (one or several levels) exists below `parent`.
bool exists(hid_t parent, const std::string& path);

/// Attributes. Strings are fixed-length, ASCII, scalar, as H5MD wants them.
void write_attribute(hid_t object, const std::string& name, const std::string& text);
void write_attribute(hid_t object, const std::string& name, const std::vector<std::string>& texts);
void write_attribute(hid_t object, const std::string& name, int value);
void write_attribute(hid_t object, const std::string& name, const std::vector<int>& values);

/// Whole datasets, written once. Scalars are rank 0.
template <class T>
void write_dataset(hid_t parent, const std::string& name, const T* values, const std::vector<hsize_t>& shape);
void write_scalar(hid_t parent, const std::string& name, double value);
void write_text(hid_t parent, const std::string& name, const std::string& text);

/// Reads. An absent or differently shaped object is an empty result; a damaged one throws RunError.
bool read_scalar(hid_t parent, const std::string& name, double& value);
bool read_text(hid_t parent, const std::string& name, std::string& text);
/// Fixed- or variable-length string attribute, scalar or list.
std::vector<std::string> read_text_attribute(hid_t object, const std::string& name);
std::vector<int> read_int_attribute(hid_t object, const std::string& name);
template <class T>
std::vector<T> read_dataset(hid_t parent, const std::string& name);
/// Extents of a dataset; empty for a scalar.
std::vector<hsize_t> extents(hid_t dataset);

/// Bytes that the file holds of a dataset, compressed or not; never more than the file is long.
std::uint64_t stored_bytes(hid_t dataset);
/// Refuses a dataset that claims more than the file can hold of it: more than a megabyte and 1100 times the
/// bytes stored, which is above what deflate packs; or that is deflated more than once. Reading it would take
/// memory and time that the file does not explain. \throws RunError
void require_stored(hid_t dataset, const std::string& name);

/// A dataset that grows along its first dimension, one record per frame.
class Series {
 public:
  Series() = default;
  /// \param record shape of one record (may be empty: a scalar series)
  /// \param records_per_chunk 1 for bead columns, 1024 for scalar series
  Series(hid_t group, const std::string& name, hid_t file_type, std::vector<hsize_t> record,
         hsize_t records_per_chunk, const void* fill = nullptr);
  /// Opens an existing dataset for reading.
  Series(hid_t group, const std::string& name);
  [[nodiscard]] explicit operator bool() const { return static_cast<bool>(dataset_); }
  [[nodiscard]] hsize_t size() const { return size_; }
  [[nodiscard]] const std::vector<hsize_t>& record() const { return record_; }
  void append(hid_t memory_type, const void* values);
  void read(hsize_t index, hid_t memory_type, void* values) const;
  /// `count` records one after the other.
  void append(hid_t memory_type, const void* values, hsize_t count);
  void read(hsize_t index, hid_t memory_type, void* values, hsize_t count) const;

 private:
  Handle dataset_;
  std::vector<hsize_t> record_;
  hsize_t size_ = 0;
};

}  // namespace twincell::h5
