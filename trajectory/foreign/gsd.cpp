// GSD: the binary format of HOOMD-blue, file layer 2.0, schema "hoomd" 1.4. Sources: GSD manual, "File layer"
// and "HOOMD schema". Positions are single precision and relative to the centre of the box; the lower corner
// of the box and the identities of the beads are kept in chunks log/, which other programs ignore.

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <cstring>
#include <fstream>
#include <limits>
#include <map>

#include "core/error.hpp"
#include "trajectory/foreign/format.hpp"
#include "trajectory/foreign/text_file.hpp"

namespace twincell {

namespace {

constexpr std::uint64_t kMagic = 0x65DF65DF65DF65DF;
constexpr std::uint32_t kFileVersion = 2U << 16;         // 2.0
constexpr std::uint32_t kSchemaVersion = 1U << 16 | 4U;  // 1.4
constexpr std::size_t kNameBytes = 64;
constexpr const char* kApplication = "twincell";

struct Header {
  std::uint64_t magic = kMagic, index_at = 0, index_entries = 0, names_at = 0, name_entries = 0;
  std::uint32_t schema_version = kSchemaVersion, file_version = kFileVersion;
  char application[64] = {}, schema[64] = {}, reserved[80] = {};
};
static_assert(sizeof(Header) == 256);

struct IndexEntry {
  std::uint64_t frame = 0, n = 0;
  std::int64_t at = 0;
  std::uint32_t m = 0;
  std::uint16_t id = 0;
  std::uint8_t type = 0, flags = 0;
};
static_assert(sizeof(IndexEntry) == 32);

/// Types of a chunk's values.
enum class Type : std::uint8_t { u8 = 1, u16, u32, u64, i8, i16, i32, i64, f32, f64 };

std::size_t bytes_of(std::uint8_t type) {
  constexpr std::array<std::size_t, 11> bytes = {0, 1, 2, 4, 8, 1, 2, 4, 8, 4, 8};
  return type < bytes.size() ? bytes[type] : 0;
}

template <class Number>
constexpr Type type_of() {
  if constexpr (std::is_same_v<Number, float>) return Type::f32;
  if constexpr (std::is_same_v<Number, double>) return Type::f64;
  if constexpr (std::is_same_v<Number, std::uint8_t>) return Type::u8;
  if constexpr (std::is_same_v<Number, std::int8_t>) return Type::i8;
  if constexpr (std::is_same_v<Number, std::uint32_t>) return Type::u32;
  if constexpr (std::is_same_v<Number, std::int32_t>) return Type::i32;
  if constexpr (std::is_same_v<Number, std::uint64_t>) return Type::u64;
  return Type::i64;
}

class GsdWriter final : public ForeignWriter {
 public:
  GsdWriter(const std::filesystem::path& part, const WriteOptions& options)
      : file_(part),
        out_(part, std::ios::binary | std::ios::trunc),
        has_(options.columns),
        is_2d_(options.dimension == 2) {
    write(Header{});  // with its final values in finish()
  }

  void append(const ForeignFrame& s) override {
    const std::size_t n = s.beads.size();
    const Vec3 size = s.upper - s.lower, centre = 0.5 * (s.upper + s.lower);
    chunk<std::uint64_t>("configuration/step",
                         {static_cast<std::uint64_t>(std::max<std::int64_t>(s.step, 0))}, 1);
    if (frame_ == 0)
      chunk<std::uint8_t>("configuration/dimensions", {static_cast<std::uint8_t>(is_2d_ ? 2 : 3)}, 1);
    // HOOMD: a two-dimensional box has no depth.
    chunk<float>("configuration/box",
                 {static_cast<float>(size[0]), static_cast<float>(size[1]),
                  is_2d_ ? 0.0F : static_cast<float>(size[2]), 0, 0, 0},
                 1);
    chunk<std::uint32_t>("particles/N", {static_cast<std::uint32_t>(n)}, 1);
    if (frame_ == 0) {
      std::vector<std::int8_t> types(14, 0);
      std::memcpy(types.data(), "bead", 4);
      std::memcpy(types.data() + 7, "tracer", 6);
      chunk<std::int8_t>("particles/types", types, 7);
    }
    std::vector<std::uint32_t> typeid_;
    std::vector<float> mass, diameter, position, velocity;
    std::vector<std::int32_t> image;
    std::vector<double> ids;
    for (const ForeignBead& bead : s.beads) {
      typeid_.push_back(bead.type == 2 ? 1 : 0);
      mass.push_back(static_cast<float>(bead.mass));
      diameter.push_back(static_cast<float>(2 * bead.radius));
      ids.push_back(static_cast<double>(bead.id));
      for (int k = 0; k < 3; ++k) {
        double r = is_2d_ && k == 2 ? 0 : bead.position[k] - centre[k];
        double periods = 0;
        if (s.periodic[static_cast<std::size_t>(k)] && !(is_2d_ && k == 2)) {
          periods = std::floor(r / size[k] + 0.5);
          r -= periods * size[k];
        }
        position.push_back(static_cast<float>(r));
        image.push_back(static_cast<std::int32_t>(periods));
        velocity.push_back(static_cast<float>(bead.velocity[k]));
      }
    }
    chunk("particles/typeid", typeid_, 1);
    if (has_.mass) chunk("particles/mass", mass, 1);
    if (has_.radius) chunk("particles/diameter", diameter, 1);
    chunk("particles/position", position, 3);
    if (has_.velocity[0]) chunk("particles/velocity", velocity, 3);
    chunk("particles/image", image, 3);
    chunk("log/particles/id", ids, 1);
    chunk<double>("log/configuration/centre", {centre[0], centre[1], is_2d_ ? 0 : centre[2]}, 3);
    chunk<double>("log/configuration/periodic",
                  {s.periodic[0] ? 1. : 0., s.periodic[1] ? 1. : 0., s.periodic[2] ? 1. : 0.}, 3);
    if (s.time) chunk<double>("log/configuration/time", {*s.time}, 1);
    if (is_2d_) chunk<double>("log/configuration/gap", {size[2]}, 1);
    ++frame_;
    check();
  }

  void finish() override {
    Header header;
    std::strncpy(header.application, kApplication, sizeof header.application - 1);
    std::strncpy(header.schema, "hoomd", sizeof header.schema - 1);
    header.index_at = at_;
    // The index is sorted by frame, then by id of the name; unused entries at its end are zero.
    std::stable_sort(index_.begin(), index_.end(), [](const IndexEntry& a, const IndexEntry& b) {
      return a.frame != b.frame ? a.frame < b.frame : a.id < b.id;
    });
    index_.emplace_back();
    header.index_entries = index_.size();
    for (const IndexEntry& entry : index_) write(entry);
    header.names_at = at_;
    std::string names;
    for (const std::string& name : names_) names += name + '\0';
    header.name_entries = names.size() / kNameBytes + 1;
    names.resize(header.name_entries * kNameBytes, '\0');
    out_.write(names.data(), static_cast<std::streamsize>(names.size()));
    out_.seekp(0);
    out_.write(reinterpret_cast<const char*>(&header), sizeof header);
    out_.close();
    check();
  }

 private:
  template <class Pod>
  void write(const Pod& pod) {
    out_.write(reinterpret_cast<const char*>(&pod), sizeof pod);
    at_ += sizeof pod;
  }
  template <class Number>
  void chunk(const std::string& name, const std::vector<Number>& values, std::uint32_t columns) {
    if (values.empty()) return;
    const auto known = std::find(names_.begin(), names_.end(), name);
    const auto id = static_cast<std::uint16_t>(known - names_.begin());
    if (known == names_.end()) names_.push_back(name);
    index_.push_back({.frame = frame_,
                      .n = values.size() / columns,
                      .at = static_cast<std::int64_t>(at_),
                      .m = columns,
                      .id = id,
                      .type = static_cast<std::uint8_t>(type_of<Number>())});
    const std::size_t n = values.size() * sizeof(Number);
    out_.write(reinterpret_cast<const char*>(values.data()), static_cast<std::streamsize>(n));
    at_ += n;
  }
  void check() const {
    if (!out_)
      throw RunError(fmt::format("{}: cannot be written: {}.", file_.string(), std::strerror(errno)));
  }

  std::filesystem::path file_;
  std::ofstream out_;
  ForeignColumns has_;
  bool is_2d_;
  std::uint64_t at_ = 0, frame_ = 0;
  std::vector<std::string> names_;
  std::vector<IndexEntry> index_;
};

class GsdReader final : public ForeignReader {
 public:
  GsdReader(const std::filesystem::path& file, const ReadOptions& options)
      : ForeignReader(file),
        in_(open_input(file)),
        size_(size_of_input(file)),
        is_2d_(options.dimension == 2) {
    read_index();
  }

  bool next(ForeignFrame& s) override {
    if (frame_ == n_frames_) return false;
    s = ForeignFrame{};
    const auto step = numbers("configuration/step", 1, 1);
    s.step = step.empty() ? static_cast<std::int64_t>(frame_) : whole("configuration/step", step[0]);
    if (const auto time = numbers("log/configuration/time", 1, 1); !time.empty()) s.time = time[0];
    const auto count = numbers("particles/N", 1, 1);
    const std::int64_t announced = count.empty() ? 0 : whole("particles/N", count[0]);
    if (announced < 0 || announced > size_)
      fail_at(0, fmt::format("{} beads are announced in a file of {} bytes.", announced, size_));
    const auto n = static_cast<std::size_t>(announced);
    const Vec3 centre = read_box(s);
    const auto position = numbers("particles/position", n, 3);
    if (position.empty() && n > 0) fail_at(0, fmt::format("frame {} has no positions.", frame_));
    const bool planar = is_2d_ && states_plane();
    const auto velocity = numbers("particles/velocity", n, 3, true), image = numbers("particles/image", n, 3),
               diameter = numbers("particles/diameter", n, 1), mass = numbers("particles/mass", n, 1),
               types = numbers("particles/typeid", n, 1), ids = numbers("log/particles/id", n, 1);
    has_.radius = has_.radius || !diameter.empty();
    has_.mass = has_.mass || !mass.empty();
    has_.type = has_.type || !types.empty();
    if (!velocity.empty()) has_.velocity.fill(true);
    has_.wrapped.fill(!has_images_);  // frames without the chunk have images 0 if another frame has it
    const Vec3 size = s.upper - s.lower;
    for (std::size_t i = 0; i < n; ++i) {
      ForeignBead bead;
      bead.id = ids.empty() ? static_cast<std::int64_t>(i) : whole("log/particles/id", ids[i]);
      bead.type = types.empty() ? 1 : whole("particles/typeid", types[i]) + 1;
      bead.radius = diameter.empty() ? 0.5 : diameter[i] / 2;  // HOOMD's default diameter is 1
      bead.mass = mass.empty() ? 1 : mass[i];
      if (!(bead.radius > 0)) fail_at(0, fmt::format("bead {} of frame {} has no size.", i, frame_));
      if (!(bead.mass > 0)) fail_at(0, fmt::format("bead {} of frame {} has no mass.", i, frame_));
      for (int k = 0; k < (is_2d_ ? 2 : 3); ++k) {
        const std::size_t at = 3 * i + static_cast<std::size_t>(k);
        bead.position[k] = position[at] + centre[k] + (image.empty() ? 0 : image[at] * size[k]);
        if (!velocity.empty()) bead.velocity[k] = velocity[at];
      }
      // A z that differs between beads is refused by ForeignTrajectory.
      if (is_2d_ && !planar) bead.position.z() = position[3 * i + 2] + centre.z();
      s.beads.push_back(bead);
    }
    ++frame_;
    return true;
  }
  [[nodiscard]] const ForeignColumns& columns() const override { return has_; }
  [[nodiscard]] std::int64_t size() const override { return static_cast<std::int64_t>(n_frames_); }
  [[nodiscard]] std::int64_t done() const override { return static_cast<std::int64_t>(frame_); }

 private:
  void read_at(std::uint64_t at, void* data, std::size_t n, const char* what) {
    if (at > static_cast<std::uint64_t>(size_) || n > static_cast<std::uint64_t>(size_) - at)
      fail_at(0, fmt::format("is truncated: {} ends beyond its {} bytes.", what, size_));
    in_.seekg(static_cast<std::streamoff>(at));
    in_.read(static_cast<char*>(data), static_cast<std::streamsize>(n));
    if (!in_) fail_at(0, fmt::format("cannot be read: {} is incomplete.", what));
  }

  void read_index() {
    Header header;
    read_at(0, &header, sizeof header, "the header");
    if (header.magic != kMagic) fail_at(0, "is not a GSD file.");
    if (header.file_version >> 16 < 1 || header.file_version >> 16 > 2)
      fail_at(0, fmt::format("has version {}.{} of the file layer; 1 and 2 are read.",
                             header.file_version >> 16, header.file_version & 0xFFFF));
    if (std::string(header.schema, strnlen(header.schema, sizeof header.schema)) != "hoomd")
      fail_at(0, "has another schema than \"hoomd\".");
    const auto fits = [&](std::uint64_t entries, std::size_t bytes, const char* what) {
      if (entries > static_cast<std::uint64_t>(size_) / bytes)
        fail_at(0, fmt::format("is truncated: {} announces {} entries in a file of {} bytes.", what, entries,
                               size_));
    };
    fits(header.name_entries, kNameBytes, "the list of names");
    fits(header.index_entries, sizeof(IndexEntry), "the index");
    std::string names(header.name_entries * kNameBytes, '\0');
    read_at(header.names_at, names.data(), names.size(), "the list of names");
    // Version 1: a name of 64 bytes each; version 2: one after another, each ended by a zero byte.
    if (header.file_version >> 16 == 1) {
      for (std::size_t i = 0; i + kNameBytes <= names.size(); i += kNameBytes)
        names_.emplace_back(names.c_str() + i);
    } else {
      for (std::size_t at = 0; at < names.size() && names[at] != '\0'; at += names_.back().size() + 1)
        names_.emplace_back(names.c_str() + at);
    }
    std::vector<IndexEntry> index(header.index_entries);
    read_at(header.index_at, index.data(), index.size() * sizeof(IndexEntry), "the index");
    for (const IndexEntry& e : index) {
      if (e.at == 0) break;
      if (e.id >= names_.size() || bytes_of(e.type) == 0 || e.m == 0 || e.frame > index.size())
        fail_at(0, "is damaged: an entry of its index has no name or no type.");
      index_[{names_[e.id], e.frame}] = e;
      has_images_ = has_images_ || names_[e.id] == "particles/image";
      n_frames_ = std::max(n_frames_, e.frame + 1);
    }
    if (n_frames_ == 0) fail_at(0, "the file holds no frame.");
  }

  /// Values of a chunk of the present frame, or else of frame 0, which has the defaults; empty if there is
  /// none of `n` rows. \param may_be_nan NaN is a value too: a velocity that is unknown
  std::vector<double> numbers(const std::string& name, std::size_t n, std::uint32_t columns,
                              bool may_be_nan = false) {
    auto found = index_.find({name, frame_});
    if (found == index_.end()) {
      found = index_.find({name, 0});
      if (found == index_.end() || found->second.n != n) return {};
    }
    const IndexEntry& e = found->second;
    if (static_cast<std::uint64_t>(e.n) * e.m != static_cast<std::uint64_t>(n) * columns ||
        e.n > static_cast<std::uint64_t>(size_))
      fail_at(0, fmt::format("{} of frame {} has {} x {} values; {} x {} are needed.", name, e.frame, e.n,
                             e.m, n, columns));
    const std::size_t total = n * columns, width = bytes_of(e.type);
    std::vector<char> raw(total * width);
    read_at(static_cast<std::uint64_t>(e.at), raw.data(), raw.size(), name.c_str());
    std::vector<double> values(total);
    for (std::size_t i = 0; i < total; ++i) {
      values[i] = value_of(raw.data() + i * width, static_cast<Type>(e.type));
      if (std::isinf(values[i]) || (std::isnan(values[i]) && !may_be_nan))
        fail_at(0, fmt::format("{} of frame {} has a value that is not finite.", name, e.frame));
    }
    return values;
  }

  [[nodiscard]] std::int64_t whole(const char* name, double value) const {
    const auto integer = integer_of(value);
    if (!integer)
      fail_at(0, fmt::format("{} of frame {} has {:g}, not a whole number within {:g}.", name, frame_, value,
                             kExact));
    return *integer;
  }

  template <class Number>
  static double as(const char* bytes) {
    Number value;
    std::memcpy(&value, bytes, sizeof value);
    return static_cast<double>(value);
  }
  static double value_of(const char* bytes, Type type) {
    switch (type) {
      case Type::u8:
        return as<std::uint8_t>(bytes);
      case Type::u16:
        return as<std::uint16_t>(bytes);
      case Type::u32:
        return as<std::uint32_t>(bytes);
      case Type::u64:
        return as<std::uint64_t>(bytes);
      case Type::i8:
        return as<std::int8_t>(bytes);
      case Type::i16:
        return as<std::int16_t>(bytes);
      case Type::i32:
        return as<std::int32_t>(bytes);
      case Type::i64:
        return as<std::int64_t>(bytes);
      case Type::f32:
        return as<float>(bytes);
      case Type::f64:
        return as<double>(bytes);
    }
    return 0;
  }

  /// Whether the file says that its beads lie in a plane. HOOMD's default is three dimensions.
  bool states_plane() {
    const auto dimensions = numbers("configuration/dimensions", 1, 1);
    return !dimensions.empty() && dimensions[0] == 2;
  }

  /// Reads the box. \returns what is added to positions: the centre of the box, or 0 where the file has none
  Vec3 read_box(ForeignFrame& s) {
    const auto box = numbers("configuration/box", 6, 1);
    const auto flat = box.empty() ? std::vector<double>{1, 1, 1, 0, 0, 0} : box;
    if (flat[3] != 0 || flat[4] != 0 || flat[5] != 0) fail_at(0, "the box is not a cuboid along the axes.");
    const auto centre = numbers("log/configuration/centre", 1, 3);
    const auto periodic = numbers("log/configuration/periodic", 1, 3),
               gap = numbers("log/configuration/gap", 1, 1);
    const Vec3 middle = centre.empty() ? Vec3::Zero() : Vec3(centre[0], centre[1], centre[2]);
    Vec3 size(flat[0], flat[1], flat[2]);
    if (is_2d_) size.z() = gap.empty() ? 1 : gap[0];
    if (!(size.minCoeff() > 0)) fail_at(0, "the box is empty.");
    s.lower = middle - 0.5 * size;
    s.upper = middle + 0.5 * size;
    // HOOMD's box is periodic along all axes.
    for (std::size_t k = 0; k < 3; ++k) s.periodic[k] = periodic.empty() || periodic[k] != 0;
    return middle;
  }

  std::ifstream in_;
  std::int64_t size_;
  bool is_2d_;
  std::vector<std::string> names_;
  std::map<std::pair<std::string, std::uint64_t>, IndexEntry> index_;
  ForeignColumns has_;
  std::uint64_t frame_ = 0, n_frames_ = 0;
  bool has_images_ = false;  ///< a frame states how many periods beads have crossed
};

}  // namespace

extern const ForeignFormat gsd_format;
const ForeignFormat gsd_format = {
    .word = "gsd",
    .extensions = ".gsd",
    .help = "GSD, schema hoomd, single precision: HOOMD-blue, freud, OVITO",
    .open = [](const std::filesystem::path& file, const ReadOptions& options)
        -> std::unique_ptr<ForeignReader> { return std::make_unique<GsdReader>(file, options); },
    .create = [](const std::filesystem::path& part, const WriteOptions& options)
        -> std::unique_ptr<ForeignWriter> { return std::make_unique<GsdWriter>(part, options); },
    .mark = kApplication};

}  // namespace twincell
