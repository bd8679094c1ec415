#include "core/hdf5.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cstdint>
#include <numeric>
#include <string_view>

#include "core/error.hpp"

namespace twincell::h5 {

namespace {

/// Reason of the innermost function in HDF5's error stack, the most specific one.
std::string reason() {
  std::string text;
  auto visit = [](unsigned, const H5E_error2_t* entry, void* out) -> herr_t {
    if (entry->desc != nullptr && *entry->desc != '\0') *static_cast<std::string*>(out) = entry->desc;
    return 0;
  };
  H5Ewalk2(H5E_DEFAULT, H5E_WALK_DOWNWARD, visit, &text);  // the last visit is the innermost
  H5Eclear2(H5E_DEFAULT);
  // For a failed write, HDF5 quotes the system's message among times, descriptors and addresses. Keep only
  // the message.
  constexpr std::string_view kBefore = "error message = '";
  if (const std::size_t at = text.find(kBefore); at != std::string::npos) {
    const std::size_t begin = at + kBefore.size();
    text = text.substr(begin, text.find('\'', begin) - begin);
  }
  return text.empty() ? "no reason given by HDF5" : text;
}

Handle fixed_string(std::size_t length) {
  Handle type = own(H5Tcopy(H5T_C_S1), "making a string type");
  check(H5Tset_size(type.get(), std::max<std::size_t>(length, 1)), "sizing a string type");
  check(H5Tset_strpad(type.get(), H5T_STR_NULLPAD), "padding a string type");
  return type;
}

Handle simple_space(const std::vector<hsize_t>& shape) {
  if (shape.empty()) return own(H5Screate(H5S_SCALAR), "making a scalar space");
  return own(H5Screate_simple(static_cast<int>(shape.size()), shape.data(), nullptr), "making a space");
}

void put_attribute(hid_t object, const std::string& name, hid_t type, const Handle& space, const void* data) {
  const Handle attribute = own(H5Acreate2(object, name.c_str(), type, space.get(), H5P_DEFAULT, H5P_DEFAULT),
                               "making attribute " + name);
  check(H5Awrite(attribute.get(), type, data), "writing attribute " + name);
}

std::string trimmed(const char* data, std::size_t size) {
  return {data, std::find(data, data + size, '\0')};
}

}  // namespace

Handle::~Handle() {
  reset();
}

void Handle::reset() {
  if (id_ < 0) return;
  switch (H5Iget_type(id_)) {
    case H5I_FILE:
      H5Fclose(id_);
      break;
    case H5I_GROUP:
      H5Gclose(id_);
      break;
    case H5I_DATASET:
      H5Dclose(id_);
      break;
    case H5I_DATATYPE:
      H5Tclose(id_);
      break;
    case H5I_DATASPACE:
      H5Sclose(id_);
      break;
    case H5I_ATTR:
      H5Aclose(id_);
      break;
    case H5I_GENPROP_LST:
      H5Pclose(id_);
      break;
    default:
      H5Idec_ref(id_);
      break;
  }
  id_ = -1;
}

Handle own(hid_t id, const std::string& what) {
  if (id < 0) throw RunError(what + " failed: " + reason() + ".");
  return Handle(id);
}

void check(herr_t status, const std::string& what) {
  if (status < 0) throw RunError(what + " failed: " + reason() + ".");
}

void quiet() {
  // After a failed write, the file stays half open in the library, whose cleanup at exit then fails.
  H5dont_atexit();
  H5Eset_auto2(H5E_DEFAULT, nullptr, nullptr);
}

template <>
hid_t native<double>() {
  return H5T_NATIVE_DOUBLE;
}
template <>
hid_t native<int>() {
  return H5T_NATIVE_INT;
}
template <>
hid_t native<std::int64_t>() {
  return H5T_NATIVE_INT64;
}
template <>
hid_t native<std::uint8_t>() {
  return H5T_NATIVE_UINT8;
}
template <>
hid_t native<std::int8_t>() {
  return H5T_NATIVE_INT8;
}

Handle create_group(hid_t parent, const std::string& name) {
  return own(H5Gcreate2(parent, name.c_str(), H5P_DEFAULT, H5P_DEFAULT, H5P_DEFAULT), "making group " + name);
}

bool exists(hid_t parent, const std::string& path) {
  for (std::size_t end = path.find('/', 1);; end = path.find('/', end + 1)) {
    const std::string head = path.substr(0, end);
    if (H5Lexists(parent, head.c_str(), H5P_DEFAULT) <= 0) return false;
    if (end == std::string::npos) return true;
  }
}

void write_attribute(hid_t object, const std::string& name, const std::string& text) {
  const Handle type = fixed_string(text.size());
  put_attribute(object, name, type.get(), simple_space({}), text.empty() ? "\0" : text.data());
}

void write_attribute(hid_t object, const std::string& name, const std::vector<std::string>& texts) {
  std::size_t length = 1;
  for (const auto& t : texts) length = std::max(length, t.size());
  std::string packed(length * texts.size(), '\0');
  for (std::size_t i = 0; i < texts.size(); ++i)
    std::copy(texts[i].begin(), texts[i].end(), packed.begin() + static_cast<std::ptrdiff_t>(i * length));
  const Handle type = fixed_string(length);
  put_attribute(object, name, type.get(), simple_space({texts.size()}), packed.data());
}

void write_attribute(hid_t object, const std::string& name, int value) {
  put_attribute(object, name, H5T_NATIVE_INT32, simple_space({}), &value);
}

void write_attribute(hid_t object, const std::string& name, const std::vector<int>& values) {
  put_attribute(object, name, H5T_NATIVE_INT32, simple_space({values.size()}), values.data());
}

template <class T>
void write_dataset(hid_t parent, const std::string& name, const T* values,
                   const std::vector<hsize_t>& shape) {
  const Handle space = simple_space(shape);
  const Handle set =
      own(H5Dcreate2(parent, name.c_str(), native<T>(), space.get(), H5P_DEFAULT, H5P_DEFAULT, H5P_DEFAULT),
          "making " + name);
  const hsize_t count = std::accumulate(shape.begin(), shape.end(), hsize_t{1}, std::multiplies<>());
  if (count > 0)
    check(H5Dwrite(set.get(), native<T>(), H5S_ALL, H5S_ALL, H5P_DEFAULT, values), "writing " + name);
}
template void write_dataset(hid_t, const std::string&, const double*, const std::vector<hsize_t>&);
template void write_dataset(hid_t, const std::string&, const int*, const std::vector<hsize_t>&);
template void write_dataset(hid_t, const std::string&, const std::int64_t*, const std::vector<hsize_t>&);
template void write_dataset(hid_t, const std::string&, const std::uint8_t*, const std::vector<hsize_t>&);

void write_scalar(hid_t parent, const std::string& name, double value) {
  write_dataset(parent, name, &value, {});
}

void write_text(hid_t parent, const std::string& name, const std::string& text) {
  const Handle type = fixed_string(text.size());
  check(H5Tset_cset(type.get(), H5T_CSET_UTF8), "choosing UTF-8");
  const Handle space = simple_space({});
  const Handle set =
      own(H5Dcreate2(parent, name.c_str(), type.get(), space.get(), H5P_DEFAULT, H5P_DEFAULT, H5P_DEFAULT),
          "making " + name);
  check(H5Dwrite(set.get(), type.get(), H5S_ALL, H5S_ALL, H5P_DEFAULT, text.empty() ? "\0" : text.data()),
        "writing " + name);
}

namespace {

Handle open_dataset(hid_t parent, const std::string& name) {
  if (!exists(parent, name)) return {};
  const Handle object = own(H5Oopen(parent, name.c_str(), H5P_DEFAULT), "opening " + name);
  if (H5Iget_type(object.get()) != H5I_DATASET) return {};
  return own(H5Dopen2(parent, name.c_str(), H5P_DEFAULT), "opening " + name);
}

bool is_class(const Handle& dataset, std::initializer_list<H5T_class_t> classes) {
  const Handle type = own(H5Dget_type(dataset.get()), "reading a type");
  return std::find(classes.begin(), classes.end(), H5Tget_class(type.get())) != classes.end();
}

hsize_t count_of(const std::vector<hsize_t>& shape) {
  return std::accumulate(shape.begin(), shape.end(), hsize_t{1}, std::multiplies<>());
}

/// Strings of a dataset or an attribute; `read` reads them into the given memory.
template <class Read>
std::vector<std::string> read_strings(hid_t type_id, hid_t space_id, Read read) {
  const hssize_t n = H5Sget_simple_extent_npoints(space_id);
  if (H5Tget_class(type_id) != H5T_STRING || n <= 0) return {};
  std::vector<std::string> out;
  if (H5Tis_variable_str(type_id) > 0) {
    const Handle memory = own(H5Tcopy(H5T_C_S1), "making a string type");
    check(H5Tset_size(memory.get(), H5T_VARIABLE), "sizing a string type");
    check(H5Tset_cset(memory.get(), H5Tget_cset(type_id)), "choosing a character set");
    std::vector<char*> raw(static_cast<std::size_t>(n), nullptr);
    check(read(memory.get(), raw.data()), "reading a string");
    for (char* p : raw) out.emplace_back(p == nullptr ? "" : p);
    H5Dvlen_reclaim(memory.get(), space_id, H5P_DEFAULT, raw.data());
  } else {
    const std::size_t length = H5Tget_size(type_id);
    std::vector<char> raw(length * static_cast<std::size_t>(n));
    check(read(type_id, raw.data()), "reading a string");
    for (hssize_t i = 0; i < n; ++i)
      out.push_back(trimmed(raw.data() + static_cast<std::size_t>(i) * length, length));
  }
  return out;
}

}  // namespace

bool read_scalar(hid_t parent, const std::string& name, double& value) {
  const Handle set = open_dataset(parent, name);
  if (!set || !extents(set.get()).empty() || !is_class(set, {H5T_FLOAT, H5T_INTEGER})) return false;
  check(H5Dread(set.get(), H5T_NATIVE_DOUBLE, H5S_ALL, H5S_ALL, H5P_DEFAULT, &value), "reading " + name);
  return true;
}

bool read_text(hid_t parent, const std::string& name, std::string& text) {
  const Handle set = open_dataset(parent, name);
  if (!set) return false;
  const Handle type = own(H5Dget_type(set.get()), "reading a type");
  const Handle space = own(H5Dget_space(set.get()), "reading a space");
  const auto strings = read_strings(type.get(), space.get(), [&](hid_t memory, void* out) {
    return H5Dread(set.get(), memory, H5S_ALL, H5S_ALL, H5P_DEFAULT, out);
  });
  if (strings.empty()) return false;
  text = strings.front();
  return true;
}

std::vector<std::string> read_text_attribute(hid_t object, const std::string& name) {
  if (H5Aexists(object, name.c_str()) <= 0) return {};
  const Handle attribute = own(H5Aopen(object, name.c_str(), H5P_DEFAULT), "opening attribute " + name);
  const Handle type = own(H5Aget_type(attribute.get()), "reading a type");
  const Handle space = own(H5Aget_space(attribute.get()), "reading a space");
  return read_strings(type.get(), space.get(),
                      [&](hid_t memory, void* out) { return H5Aread(attribute.get(), memory, out); });
}

std::vector<int> read_int_attribute(hid_t object, const std::string& name) {
  if (H5Aexists(object, name.c_str()) <= 0) return {};
  const Handle attribute = own(H5Aopen(object, name.c_str(), H5P_DEFAULT), "opening attribute " + name);
  const Handle type = own(H5Aget_type(attribute.get()), "reading a type");
  if (H5Tget_class(type.get()) != H5T_INTEGER) return {};
  const Handle space = own(H5Aget_space(attribute.get()), "reading a space");
  const hssize_t n = H5Sget_simple_extent_npoints(space.get());
  std::vector<int> values(static_cast<std::size_t>(std::max<hssize_t>(n, 0)));
  if (n > 0) check(H5Aread(attribute.get(), H5T_NATIVE_INT, values.data()), "reading attribute " + name);
  return values;
}

void require_stored(hid_t dataset, const std::string& name) {
  // Deflate compresses at most 1032 to 1. Small datasets may consist of fill values only.
  constexpr double kMaxPacked = 1100, kSmall = 1 << 20;
  double claimed = 1;
  for (const hsize_t n : extents(dataset)) claimed *= static_cast<double>(n);
  const Handle type = own(H5Dget_type(dataset), "reading a type");
  claimed *= static_cast<double>(H5Tget_size(type.get()));
  const auto stored = static_cast<double>(stored_bytes(dataset));
  if (claimed > kSmall + kMaxPacked * stored)
    throw RunError(fmt::format("{}: the dataset claims {:.3g} bytes, and the file holds {:.3g} of them.",
                               name, claimed, stored));
  // Deflated twice, a kilobyte expands to a gigabyte before its size can be checked.
  const Handle layout = own(H5Dget_create_plist(dataset), "reading the layout");
  int packings = 0;
  for (int i = 0; i < H5Pget_nfilters(layout.get()); ++i) {
    unsigned flags = 0;
    std::size_t values = 0;
    if (H5Pget_filter2(layout.get(), static_cast<unsigned>(i), &flags, &values, nullptr, 0, nullptr,
                       nullptr) == H5Z_FILTER_DEFLATE)
      ++packings;
  }
  if (packings > 1) throw RunError(fmt::format("{}: the dataset is compressed {} times.", name, packings));
}

std::uint64_t stored_bytes(hid_t dataset) {
  // HDF5 returns the size that the file states, which may be wrong; the file size is an upper bound.
  const Handle file = own(H5Iget_file_id(dataset), "finding the file");
  hsize_t file_size = 0;
  check(H5Fget_filesize(file.get(), &file_size), "reading the size of the file");
  return std::min<std::uint64_t>(H5Dget_storage_size(dataset), file_size);
}

template <class T>
std::vector<T> read_dataset(hid_t parent, const std::string& name) {
  const Handle set = open_dataset(parent, name);
  if (!set || !is_class(set, {H5T_FLOAT, H5T_INTEGER})) return {};
  require_stored(set.get(), name);
  std::vector<T> values(count_of(extents(set.get())));
  if (!values.empty())
    check(H5Dread(set.get(), native<T>(), H5S_ALL, H5S_ALL, H5P_DEFAULT, values.data()), "reading " + name);
  return values;
}
template std::vector<double> read_dataset(hid_t, const std::string&);
template std::vector<int> read_dataset(hid_t, const std::string&);
template std::vector<std::int64_t> read_dataset(hid_t, const std::string&);
template std::vector<std::uint8_t> read_dataset(hid_t, const std::string&);

std::vector<hsize_t> extents(hid_t dataset) {
  const Handle space = own(H5Dget_space(dataset), "reading a space");
  const int rank = H5Sget_simple_extent_ndims(space.get());
  std::vector<hsize_t> shape(static_cast<std::size_t>(std::max(rank, 0)));
  if (rank > 0) H5Sget_simple_extent_dims(space.get(), shape.data(), nullptr);
  return shape;
}

Series::Series(hid_t group, const std::string& name, hid_t file_type, std::vector<hsize_t> record,
               const void* fill, Storage storage)
    : record_(std::move(record)) {
  constexpr hsize_t kNumbersPerChunk = 1024;
  const hsize_t numbers = std::max<hsize_t>(count_of(record_), 1);
  std::vector<hsize_t> now{0}, most{H5S_UNLIMITED}, chunk{std::max<hsize_t>(kNumbersPerChunk / numbers, 1)};
  for (hsize_t n : record_) {
    now.push_back(n);
    // A trajectory without beads is valid, but a maximum of zero is not.
    most.push_back(n == 0 ? H5S_UNLIMITED : n);
    chunk.push_back(std::max<hsize_t>(n, 1));
  }
  const Handle space =
      own(H5Screate_simple(static_cast<int>(now.size()), now.data(), most.data()), "making a space");
  const Handle plist = own(H5Pcreate(H5P_DATASET_CREATE), "making a property list");
  check(H5Pset_chunk(plist.get(), static_cast<int>(chunk.size()), chunk.data()), "setting chunks");
  if (!record_.empty() && storage == Storage::deflated) {
    check(H5Pset_shuffle(plist.get()), "setting shuffle");
    check(H5Pset_deflate(plist.get(), 4), "setting deflate");
  }
  if (fill != nullptr) check(H5Pset_fill_value(plist.get(), file_type, fill), "setting the fill value");
  dataset_ =
      own(H5Dcreate2(group, name.c_str(), file_type, space.get(), H5P_DEFAULT, plist.get(), H5P_DEFAULT),
          "making " + name);
}

Series::Series(hid_t group, const std::string& name) : dataset_(open_dataset(group, name)) {
  if (!dataset_) return;
  const auto shape = extents(dataset_.get());
  if (shape.empty()) {
    dataset_.reset();
    return;
  }
  require_stored(dataset_.get(), name);
  size_ = shape.front();
  record_.assign(shape.begin() + 1, shape.end());
}

namespace {

/// Selects `many` records starting at `index` and calls `move(memory space, file space)`.
template <class Move>
void with_records(hid_t dataset, const std::vector<hsize_t>& record, hsize_t index, hsize_t many, Move move) {
  std::vector<hsize_t> start{index}, count{many};
  for (hsize_t n : record) {
    start.push_back(0);
    count.push_back(n);
  }
  if (count_of(count) == 0) return;
  const Handle file_space = own(H5Dget_space(dataset), "reading a space");
  check(H5Sselect_hyperslab(file_space.get(), H5S_SELECT_SET, start.data(), nullptr, count.data(), nullptr),
        "selecting a record");
  const Handle memory_space =
      own(H5Screate_simple(static_cast<int>(count.size()), count.data(), nullptr), "making a space");
  move(memory_space.get(), file_space.get());
}

}  // namespace

void Series::append(hid_t memory_type, const void* values) {
  append(memory_type, values, 1);
}

void Series::append(hid_t memory_type, const void* values, hsize_t count) {
  std::vector<hsize_t> shape{size_ + count};
  shape.insert(shape.end(), record_.begin(), record_.end());
  check(H5Dset_extent(dataset_.get(), shape.data()), "growing a dataset");
  with_records(dataset_.get(), record_, size_, count, [&](hid_t memory, hid_t file) {
    check(H5Dwrite(dataset_.get(), memory_type, memory, file, H5P_DEFAULT, values), "writing a frame");
  });
  size_ += count;
}

void Series::read(hsize_t index, hid_t memory_type, void* values) const {
  read(index, memory_type, values, 1);
}

void Series::read(hsize_t index, hid_t memory_type, void* values, hsize_t count) const {
  with_records(dataset_.get(), record_, index, count, [&](hid_t memory, hid_t file) {
    check(H5Dread(dataset_.get(), memory_type, memory, file, H5P_DEFAULT, values), "reading a frame");
  });
}

}  // namespace twincell::h5
