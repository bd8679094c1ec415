#pragma once
/// \file
/// Wrappers of the HDF5 C API: handles that close automatically and calls that check their status.

#include <hdf5.h>

#include <cstdint>
#include <filesystem>
#include <string>
#include <utility>
#include <vector>

namespace twincell::h5 {

/// Owner of an HDF5 identifier of any kind. The destructor closes it.
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
  /// Closes the identifier.
  void reset();

 private:
  hid_t id_ = -1;
};

/// Takes ownership of a new identifier.
/// \throws RunError "`what` failed: reason given by HDF5" if it is negative
Handle own(hid_t id, const std::string& what);
/// \throws RunError with the same text if `status` is negative
void check(herr_t status, const std::string& what);
/// Disables HDF5's own error output; our messages quote its reason instead. Also disables HDF5's cleanup at
/// exit, if called before any other HDF5 function. Every function that opens a file calls this.
void quiet();

/// Native memory type of T: double, int, std::int64_t, std::uint8_t, std::int8_t.
template <class T>
hid_t native();

/// A new group `name` in `parent`.
/// \throws RunError if it exists or cannot be created
Handle create_group(hid_t parent, const std::string& name);
/// True if `path` (one or several levels) exists below `parent`.
bool exists(hid_t parent, const std::string& path);

/// Write an attribute: a value as a scalar, a vector as an array of rank 1. Strings are ASCII of fixed
/// length, as H5MD requires.
/// \throws RunError as own()
void write_attribute(hid_t object, const std::string& name, const std::string& text);
void write_attribute(hid_t object, const std::string& name, const std::vector<std::string>& texts);
void write_attribute(hid_t object, const std::string& name, int value);
void write_attribute(hid_t object, const std::string& name, const std::vector<int>& values);

/// Write a whole dataset at once.
/// \throws RunError as own()
template <class T>
void write_dataset(hid_t parent, const std::string& name, const T* values, const std::vector<hsize_t>& shape);
/// Write a dataset of rank 0.
void write_scalar(hid_t parent, const std::string& name, double value);
/// Write a text as a dataset of rank 0.
void write_text(hid_t parent, const std::string& name, const std::string& text);

/// Read a dataset or an attribute. The result for an object that is absent or of another shape is false or
/// empty.
/// \throws RunError if the object is damaged
bool read_scalar(hid_t parent, const std::string& name, double& value);
/// The same for a text.
bool read_text(hid_t parent, const std::string& name, std::string& text);
/// String attribute of fixed or variable length, scalar or list.
std::vector<std::string> read_text_attribute(hid_t object, const std::string& name);
/// Whole numbers of an attribute, scalar or list.
std::vector<int> read_int_attribute(hid_t object, const std::string& name);
/// All values of a dataset, the last index fastest.
template <class T>
std::vector<T> read_dataset(hid_t parent, const std::string& name);
/// Extents of a dataset; empty for a scalar.
std::vector<hsize_t> extents(hid_t dataset);

/// Bytes that a dataset occupies in the file, compressed or not; at most the size of the file.
std::uint64_t stored_bytes(hid_t dataset);
/// Rejects a dataset whose stated size exceeds 2^20 bytes plus 1100 times the bytes stored, more than deflate
/// can compress, or that is deflated more than once. Reading it would take memory and time out of proportion
/// to the file.
/// \throws RunError
void require_stored(hid_t dataset, const std::string& name);

/// How the records of a series that are no scalars lie in the file.
enum class Storage { deflated, plain };

/// A dataset that grows along its first dimension, one record per frame.
class Series {
 public:
  Series() = default;
  /// A chunk holds one record, or as many small ones as make 1024 numbers.
  ///
  /// \param record shape of one record; empty for a scalar series
  Series(hid_t group, const std::string& name, hid_t file_type, std::vector<hsize_t> record,
         const void* fill = nullptr, Storage storage = Storage::deflated);
  /// Opens an existing dataset for reading. The series converts to false if there is none or it is a scalar.
  Series(hid_t group, const std::string& name);
  [[nodiscard]] explicit operator bool() const { return static_cast<bool>(dataset_); }
  [[nodiscard]] hsize_t size() const { return size_; }
  [[nodiscard]] const std::vector<hsize_t>& record() const { return record_; }
  /// Append a record, or read record `index`. `values` has the memory type and the shape of the records.
  /// \throws RunError if HDF5 fails
  /// \pre index < size()
  void append(hid_t memory_type, const void* values);
  void read(hsize_t index, hid_t memory_type, void* values) const;
  /// Append or read `count` consecutive records.
  void append(hid_t memory_type, const void* values, hsize_t count);
  void read(hsize_t index, hid_t memory_type, void* values, hsize_t count) const;

 private:
  Handle dataset_;
  std::vector<hsize_t> record_;
  hsize_t size_ = 0;
};

}  // namespace twincell::h5
