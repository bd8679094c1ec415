// A 3-D dataset [frame][row][column] of an HDF5 file.

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cmath>

#include "core/error.hpp"
#include "core/hdf5.hpp"
#include "core/hdf5_open.hpp"
#include "core/hdf5_self_contained.hpp"
#include "imaging/stack/formats/byte_file.hpp"
#include "imaging/stack/formats/reader.hpp"

namespace twincell::imaging::frames {

namespace {

namespace fs = std::filesystem;

/// A dataset of three dimensions.
struct Found {
  std::string path;
  std::vector<hsize_t> shape;
};

bool is_number(hid_t dataset) {
  const h5::Handle type(H5Dget_type(dataset));
  const H5T_class_t kind = type ? H5Tget_class(type.get()) : H5T_NO_CLASS;
  return kind == H5T_INTEGER || kind == H5T_FLOAT;
}

/// All 3-D datasets of numbers, by name.
std::vector<Found> stacks_in(hid_t file) {
  std::vector<Found> found;
  const auto visit = [](hid_t root, const char* name, const H5O_info_t* object, void* to) -> herr_t {
    if (object->type != H5O_TYPE_DATASET) return 0;
    const h5::Handle dataset(H5Dopen2(root, name, H5P_DEFAULT));
    if (!dataset) return 0;
    const h5::Handle space(H5Dget_space(dataset.get()));
    if (!space || H5Sget_simple_extent_ndims(space.get()) != 3 || !is_number(dataset.get())) return 0;
    std::vector<hsize_t> shape(3);
    H5Sget_simple_extent_dims(space.get(), shape.data(), nullptr);
    static_cast<std::vector<Found>*>(to)->push_back({fmt::format("/{}", name), shape});
    return 0;
  };
  h5::check(H5Ovisit2(file, H5_INDEX_NAME, H5_ITER_INC, visit, &found, H5O_INFO_BASIC),
            "looking for datasets");
  return found;
}

class Hdf5Stack final : public FrameSource {
 public:
  Hdf5Stack(const fs::path& file, const std::string& inside) : file_(file) {
    const ByteFile readable(file);
    try {
      open(inside);
    } catch (const RunError& e) {
      // An HDF5 error here is a fault of the file, not of the run.
      refuse(file, fmt::format("cannot be read as HDF5: {}", e.what()));
    }
  }

  bool next(cv::Mat& frame) override {
    if (read_ == shape_[0]) return false;
    cv::Mat fresh(static_cast<int>(shape_[1]), static_cast<int>(shape_[2]),
                  mat_type_);  // callers may keep the previous frame
    const std::array<hsize_t, 3> start = {read_, 0, 0}, count = {1, shape_[1], shape_[2]};
    const h5::Handle in_file(H5Dget_space(dataset_.get()));
    const h5::Handle in_memory(H5Screate_simple(3, count.data(), nullptr));
    if (H5Sselect_hyperslab(in_file.get(), H5S_SELECT_SET, start.data(), nullptr, count.data(), nullptr) <
            0 ||
        H5Dread(dataset_.get(), memory_type_, in_memory.get(), in_file.get(), H5P_DEFAULT, fresh.data) < 0)
      refuse(file_, fmt::format("is truncated or damaged: frame {} of {} cannot be read.", read_, path_));
    frame = fresh;
    ++read_;
    return true;
  }
  [[nodiscard]] std::size_t announced() const override { return shape_[0]; }
  [[nodiscard]] std::string current() const override {
    return fmt::format("{}:{}, frame {}", file_.string(), path_, read_ > 0 ? read_ - 1 : 0);
  }
  [[nodiscard]] StackInfo info() const override { return info_; }

 private:
  void open(const std::string& inside) {
    const h5::Handle file = h5::open_file(file_);
    if (!file) h5::check(-1, file_.string() + ": opening it");
    if (const std::string elsewhere = h5::data_elsewhere(file.get()); !elsewhere.empty())
      refuse(file_, elsewhere);
    path_ = inside.empty() ? the_only_one(file.get()) : inside;
    if (!h5::exists(file.get(), path_)) refuse(file_, fmt::format("holds no dataset {}.", path_));
    const h5::Handle object = h5::own(H5Oopen(file.get(), path_.c_str(), H5P_DEFAULT), "opening " + path_);
    if (H5Iget_type(object.get()) != H5I_DATASET)
      refuse(file_, fmt::format("holds no dataset {}; that is a group.", path_));
    shape_ = h5::extents(object.get());
    if (shape_.size() != 3)
      refuse(file_,
             fmt::format("has {} dimensions in {}; 3 are needed: frame, row, column.", shape_.size(), path_));
    if (!is_number(object.get())) refuse(file_, fmt::format("holds no numbers in {}.", path_));
    if (shape_[0] == 0) refuse(file_, fmt::format("holds no frames in {}.", path_));
    choose_type(object.get());
    // The frame size must be plausible for the bytes stored of this dataset, regardless of other datasets in
    // the file. As for pictures, 8 bytes per pixel are assumed.
    const std::uint64_t stored = h5::stored_bytes(object.get());
    require_plausible_size(file_, shape_[2], shape_[1], 8, stored);
    require_plausible_chunks(object.get(), stored);
    h5::require_stored(object.get(), path_);  // for all frames together
    dataset_ =
        h5::own(H5Dopen2(file.get(), path_.c_str(), cache_for(object.get()).get()), "opening " + path_);
    info_.width = static_cast<int>(shape_[2]);
    info_.height = static_cast<int>(shape_[1]);
  }
  std::string the_only_one(hid_t file) const {
    if (h5::exists(file, "h5md")) refuse(file_, "is a trajectory (H5MD), not a stack of frames.");
    const std::vector<Found> found = stacks_in(file);
    if (found.size() == 1) return found[0].path;
    std::string list;
    for (const Found& f : found)
      list += fmt::format("{}{} ({} x {} x {})", list.empty() ? "" : ", ", f.path, f.shape[0], f.shape[1],
                          f.shape[2]);
    if (found.empty()) refuse(file_, "holds no dataset of three dimensions: frame, row, column.");
    refuse(file_, fmt::format("holds {} datasets of three dimensions, {}; name one, as in {}:{}.",
                              found.size(), list, file_.filename().string(), found[0].path));
  }
  // Unsigned integers of 8 and 16 bits are kept; all other types are read as float.
  void choose_type(hid_t dataset) {
    const h5::Handle type(H5Dget_type(dataset));
    const bool whole = H5Tget_class(type.get()) == H5T_INTEGER && H5Tget_sign(type.get()) == H5T_SGN_NONE;
    const std::size_t bytes = H5Tget_size(type.get());
    if (whole && bytes <= 2) {
      mat_type_ = bytes == 1 ? CV_8U : CV_16U;
      memory_type_ = bytes == 1 ? H5T_NATIVE_UINT8 : H5T_NATIVE_UINT16;
      info_.bits = static_cast<int>(H5Tget_precision(type.get()));
      info_.format = fmt::format("HDF5 stack {}, {} bit", path_, 8 * bytes);
    } else {
      mat_type_ = CV_32F;
      memory_type_ = H5T_NATIVE_FLOAT;
      info_.format = fmt::format("HDF5 stack {}, read as 32-bit real numbers", path_);
    }
  }
  /// Rejects chunks that are too large, since a compressed chunk is unpacked as a whole.
  void require_plausible_chunks(hid_t dataset, std::uint64_t stored) const {
    constexpr double always = 64U << 20, compressed = 1100;  // deflate: 1032
    const h5::Handle layout = h5::own(H5Dget_create_plist(dataset), "reading the layout");
    if (H5Pget_layout(layout.get()) != H5D_CHUNKED) return;
    std::array<hsize_t, 3> chunk{};
    h5::check(H5Pget_chunk(layout.get(), 3, chunk.data()), "reading the chunks");
    const h5::Handle type = h5::own(H5Dget_type(dataset), "reading the type");
    const double needed = static_cast<double>(chunk[0]) * static_cast<double>(chunk[1]) *
                          static_cast<double>(chunk[2]) * static_cast<double>(H5Tget_size(type.get()));
    if (needed > always && needed / compressed > static_cast<double>(stored))
      refuse(file_,
             fmt::format("states that the chunks of {} are {} x {} x {}, which the {} bytes stored of it "
                         "cannot hold.",
                         path_, chunk[0], chunk[1], chunk[2], stored));
  }
  // A chunk may contain many frames. The cache keeps all chunks that one frame touches; otherwise each chunk
  // would be read and unpacked once per frame.
  [[nodiscard]] h5::Handle cache_for(hid_t dataset) const {
    h5::Handle access = h5::own(H5Pcreate(H5P_DATASET_ACCESS), "making a property list");
    const h5::Handle layout = h5::own(H5Dget_create_plist(dataset), "reading the layout");
    if (H5Pget_layout(layout.get()) != H5D_CHUNKED) return access;
    std::array<hsize_t, 3> chunk{};
    h5::check(H5Pget_chunk(layout.get(), 3, chunk.data()), "reading the chunks");
    constexpr double most = 256U << 20;
    const auto pieces = [&](int d) {
      return std::ceil(static_cast<double>(shape_[d]) / static_cast<double>(chunk[d]));
    };
    const double needed = pieces(1) * pieces(2) * static_cast<double>(chunk[0] * chunk[1] * chunk[2]) *
                          static_cast<double>(CV_ELEM_SIZE(mat_type_));
    if (needed <= most)
      h5::check(H5Pset_chunk_cache(access.get(), H5D_CHUNK_CACHE_NSLOTS_DEFAULT,
                                   std::max(static_cast<std::size_t>(needed) + 1, std::size_t{1} << 20), 1.0),
                "sizing the cache");
    return access;
  }

  fs::path file_;
  std::string path_;
  h5::Handle dataset_;
  std::vector<hsize_t> shape_;
  hid_t memory_type_ = -1;
  int mat_type_ = CV_8U;
  hsize_t read_ = 0;
  StackInfo info_;
};

}  // namespace

extern const Reader hdf5_reader;
const Reader hdf5_reader = {
    .extensions = ".h5 .hdf5",
    .owns =
        [](const Head& head) {
          constexpr std::string_view magic("\x89HDF\r\n\x1a\n", 8);
          return head.starts_with(magic) || head.starts_with(magic, 512) || head.starts_with(magic, 1024) ||
                 head.starts_with(magic, 2048);
        },
    .open = [](const fs::path& file, const std::string& inside) -> std::unique_ptr<FrameSource> {
      return std::make_unique<Hdf5Stack>(file, inside);
    }};

}  // namespace twincell::imaging::frames
