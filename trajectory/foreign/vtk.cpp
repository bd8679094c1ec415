// VTK: a folder with one .vtp file of beads per frame and one .pvd file that lists them with their times.
// Source: VTK file formats, "XML file formats", PolyData and appended data.

#include <fmt/format.h>

#include <cstring>

#include "core/escape.hpp"
#include "trajectory/foreign/format.hpp"
#include "trajectory/foreign/text_file.hpp"

namespace twincell {

namespace {

/// Arrays of a .vtp file, whose bytes follow the XML in one block.
class Appended {
 public:
  /// Adds an array of one value that belongs to the whole frame.
  template <class Number>
  std::string add_single(const char* type, const char* name, Number value) {
    std::string element = add(type, name, 1, std::vector<Number>{value});
    element.insert(element.find(" format"), " NumberOfTuples=\"1\"");
    return element;
  }
  /// Adds an array and returns its DataArray element.
  template <class Number>
  std::string add(const char* type, const char* name, int components, const std::vector<Number>& values) {
    std::string element = fmt::format(
        R"(<DataArray type="{}" Name="{}" NumberOfComponents="{}" format="appended" offset="{}"/>)", type,
        name, components, bytes_.size());
    const std::uint64_t n = values.size() * sizeof(Number);
    append(&n, sizeof n);
    append(values.data(), n);
    return element + "\n";
  }
  [[nodiscard]] const std::string& bytes() const { return bytes_; }

 private:
  void append(const void* data, std::size_t n) {
    if (n > 0) bytes_.append(static_cast<const char*>(data), n);
  }
  std::string bytes_;
};

class VtkWriter final : public SnapshotWriter {
 public:
  VtkWriter(std::filesystem::path part, const WriteOptions& options)
      : part_(std::move(part)), has_(options.columns), options_(options) {}

  void append(const Snapshot& s) override {
    const std::string name = fmt::format("frame_{:06}.vtp", n_frames_++);
    TextOutput out(part_ / name);
    out.text() = vtp(s);
    out.close();
    list_ += fmt::format("<DataSet timestep=\"{}\" part=\"0\" file=\"{}\"/>\n", s.time.value_or(0), name);
  }

  void finish() override {
    TextOutput out(part_ / (options_.stem + ".pvd"));
    out.text() = fmt::format(
        "<?xml version=\"1.0\"?>\n<!-- Lengths in {}, times in {}. -->\n<VTKFile type=\"Collection\" "
        "version=\"0.1\" byte_order=\"LittleEndian\">\n<Collection>\n{}</Collection>\n</VTKFile>\n",
        options_.length_unit, options_.time_unit, list_);
    out.close();
  }

 private:
  [[nodiscard]] std::string vtp(const Snapshot& s) const {
    Appended data;
    const auto vectors = [&](const char* name, Vec3 SnapshotBead::*member) {
      std::vector<double> values;
      for (const SnapshotBead& bead : s.beads)
        for (int k = 0; k < 3; ++k) values.push_back((bead.*member)[k]);
      return data.add("Float64", name, 3, values);
    };
    const auto numbers = [&](const char* name, double SnapshotBead::*member) {
      std::vector<double> values;
      for (const SnapshotBead& bead : s.beads) values.push_back(bead.*member);
      return data.add("Float64", name, 1, values);
    };
    std::vector<std::int64_t> ids, ends;
    std::vector<std::uint8_t> tracers;
    for (const SnapshotBead& bead : s.beads) {
      ids.push_back(bead.id);
      ends.push_back(static_cast<std::int64_t>(ends.size()) + 1);
      tracers.push_back(bead.type == 2 ? 1 : 0);
    }
    std::vector<std::int64_t> indices;
    for (std::size_t i = 0; i < s.beads.size(); ++i) indices.push_back(static_cast<std::int64_t>(i));

    std::string x =
        "<?xml version=\"1.0\"?>\n<VTKFile type=\"PolyData\" version=\"1.0\" "
        "byte_order=\"LittleEndian\" header_type=\"UInt64\">\n<PolyData>\n<FieldData>\n";
    x += data.add_single("Float64", "TimeValue", s.time.value_or(0));
    x += data.add_single("Int64", "step", s.step);
    if (s.phase) x += data.add_single("Int64", "phase", std::int64_t{*s.phase});
    if (s.cycle) x += data.add_single("Int64", "cycle", *s.cycle);
    if (s.plate_height) x += data.add_single("Float64", "plate_height", *s.plate_height);
    x += fmt::format(
        "</FieldData>\n<Piece NumberOfPoints=\"{0}\" NumberOfVerts=\"{0}\" NumberOfLines=\"0\" "
        "NumberOfStrips=\"0\" NumberOfPolys=\"0\">\n<Points>\n",
        s.beads.size());
    x += vectors("position", &SnapshotBead::position);
    x += "</Points>\n<PointData>\n";
    x += data.add("Int64", "id", 1, ids);
    if (has_.radius) x += numbers("radius", &SnapshotBead::radius);
    if (has_.mass) x += numbers("mass", &SnapshotBead::mass);
    if (has_.type) x += data.add("UInt8", "tracer", 1, tracers);
    if (has_.velocity[0]) x += vectors("velocity", &SnapshotBead::velocity);
    if (has_.spin[2]) x += vectors("spin", &SnapshotBead::spin);
    if (has_.uncertainty) x += vectors("position_sigma", &SnapshotBead::uncertainty);
    x += "</PointData>\n<Verts>\n";  // ParaView draws points only where there are cells
    x += data.add("Int64", "connectivity", 1, indices);
    x += data.add("Int64", "offsets", 1, ends);
    x += "</Verts>\n</Piece>\n</PolyData>\n<AppendedData encoding=\"raw\">\n_";
    return x + data.bytes() + "\n</AppendedData>\n</VTKFile>\n";
  }

  std::filesystem::path part_;
  SnapshotColumns has_;
  WriteOptions options_;
  std::string list_;
  std::size_t n_frames_ = 0;
};

}  // namespace

extern const ForeignFormat vtk_format;
const ForeignFormat vtk_format = {
    .word = "vtk",
    .extensions = "",
    .help = "folder of VTK PolyData with a .pvd: ParaView, PyVista",
    .open = nullptr,
    .create = [](const std::filesystem::path& part, const WriteOptions& options)
        -> std::unique_ptr<SnapshotWriter> { return std::make_unique<VtkWriter>(part, options); },
    .folder = true};

}  // namespace twincell
