// VTK: a folder with one .vtp file of beads per frame and one .pvd file that lists them with their times;
// with contact forces also one .vtp file of lines per frame and a second .pvd file. Source: VTK file formats,
// "XML file formats", PolyData and appended data.

#include <fmt/format.h>

#include <cstring>

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

class VtkWriter final : public ForeignWriter {
 public:
  VtkWriter(std::filesystem::path part, const WriteOptions& options)
      : part_(std::move(part)), has_(options.columns), options_(options) {}

  void append(const ForeignFrame& s) override {
    beads_ += write(s, fmt::format("frame_{:06}.vtp", n_frames_), beads_of(s));
    if (has_.contacts) contacts_ += write(s, fmt::format("contacts_{:06}.vtp", n_frames_), contacts_of(s));
    ++n_frames_;
  }

  void finish() override {
    write_list(options_.stem + ".pvd", beads_);
    if (has_.contacts) write_list(options_.stem + "-contacts.pvd", contacts_);
  }

 private:
  /// Writes a file of one frame and returns its entry in the list.
  [[nodiscard]] std::string write(const ForeignFrame& s, const std::string& name,
                                  const std::string& text) const {
    TextOutput out(part_ / name);
    out.text() = text;
    out.close();
    return fmt::format("<DataSet timestep=\"{}\" part=\"0\" file=\"{}\"/>\n", s.time.value_or(0), name);
  }

  void write_list(const std::string& name, const std::string& list) const {
    TextOutput out(part_ / name);
    out.text() = fmt::format(
        "<?xml version=\"1.0\"?>\n<!-- Lengths in {}, times in {}. -->\n<VTKFile type=\"Collection\" "
        "version=\"0.1\" byte_order=\"LittleEndian\">\n<Collection>\n{}</Collection>\n</VTKFile>\n",
        options_.length_unit, options_.time_unit, list);
    out.close();
  }

  /// The beginning of a file: the numbers of the frame.
  static std::string head(const ForeignFrame& s, Appended& data) {
    std::string x =
        "<?xml version=\"1.0\"?>\n<VTKFile type=\"PolyData\" version=\"1.0\" "
        "byte_order=\"LittleEndian\" header_type=\"UInt64\">\n<PolyData>\n<FieldData>\n";
    x += data.add_single("Float64", "TimeValue", s.time.value_or(0));
    x += data.add_single("Int64", "step", s.step);
    if (s.phase) x += data.add_single("Int64", "phase", std::int64_t{*s.phase});
    if (s.cycle) x += data.add_single("Int64", "cycle", *s.cycle);
    if (s.plate_height) x += data.add_single("Float64", "plate_height", *s.plate_height);
    return x + "</FieldData>\n";
  }
  static std::string tail(const Appended& data) {
    return "</Piece>\n</PolyData>\n<AppendedData encoding=\"raw\">\n_" + data.bytes() +
           "\n</AppendedData>\n</VTKFile>\n";
  }

  /// Contacts as lines: force chains.
  [[nodiscard]] static std::string contacts_of(const ForeignFrame& s) {
    Appended data;
    std::vector<double> points, overlaps, normal, tangential;
    std::vector<std::int64_t> i, j, indices, ends;
    for (const ForeignContact& c : s.contacts) {
      for (const Vec3& end : {c.from, c.to}) {
        indices.push_back(static_cast<std::int64_t>(indices.size()));
        points.insert(points.end(), end.data(), end.data() + 3);
      }
      ends.push_back(static_cast<std::int64_t>(indices.size()));
      i.push_back(c.i), j.push_back(c.j);
      overlaps.push_back(c.overlap), normal.push_back(c.normal_force);
      tangential.insert(tangential.end(), c.tangential_force.data(), c.tangential_force.data() + 3);
    }
    std::string x = head(s, data);
    x += fmt::format(
        "<Piece NumberOfPoints=\"{}\" NumberOfVerts=\"0\" NumberOfLines=\"{}\" NumberOfStrips=\"0\" "
        "NumberOfPolys=\"0\">\n<Points>\n",
        2 * s.contacts.size(), s.contacts.size());
    x += data.add("Float64", "position", 3, points);
    x += "</Points>\n<CellData>\n";
    x += data.add("Int64", "i", 1, i);
    x += data.add("Int64", "j", 1, j);
    x += data.add("Float64", "overlap", 1, overlaps);
    x += data.add("Float64", "normal_force", 1, normal);
    x += data.add("Float64", "tangential_force", 3, tangential);
    x += "</CellData>\n<Lines>\n";
    x += data.add("Int64", "connectivity", 1, indices);
    x += data.add("Int64", "offsets", 1, ends);
    return x + "</Lines>\n" + tail(data);
  }

  [[nodiscard]] std::string beads_of(const ForeignFrame& s) const {
    Appended data;
    const auto vectors = [&](const char* name, Vec3 ForeignBead::*member) {
      std::vector<double> values;
      for (const ForeignBead& bead : s.beads)
        for (int k = 0; k < 3; ++k) values.push_back((bead.*member)[k]);
      return data.add("Float64", name, 3, values);
    };
    const auto numbers = [&](const char* name, double ForeignBead::*member) {
      std::vector<double> values;
      for (const ForeignBead& bead : s.beads) values.push_back(bead.*member);
      return data.add("Float64", name, 1, values);
    };
    std::vector<std::int64_t> ids, ends;
    std::vector<std::uint8_t> tracers;
    for (const ForeignBead& bead : s.beads) {
      ids.push_back(bead.id);
      ends.push_back(static_cast<std::int64_t>(ends.size()) + 1);
      tracers.push_back(bead.type == 2 ? 1 : 0);
    }
    std::vector<std::int64_t> indices;
    for (std::size_t i = 0; i < s.beads.size(); ++i) indices.push_back(static_cast<std::int64_t>(i));

    std::string x = head(s, data);
    x += fmt::format(
        "<Piece NumberOfPoints=\"{0}\" NumberOfVerts=\"{0}\" NumberOfLines=\"0\" "
        "NumberOfStrips=\"0\" NumberOfPolys=\"0\">\n<Points>\n",
        s.beads.size());
    x += vectors("position", &ForeignBead::position);
    x += "</Points>\n<PointData>\n";
    x += data.add("Int64", "id", 1, ids);
    if (has_.radius) x += numbers("radius", &ForeignBead::radius);
    if (has_.mass) x += numbers("mass", &ForeignBead::mass);
    if (has_.type) x += data.add("UInt8", "tracer", 1, tracers);
    if (has_.velocity[0]) x += vectors("velocity", &ForeignBead::velocity);
    if (has_.spin[2]) x += vectors("spin", &ForeignBead::spin);
    if (has_.uncertainty) x += vectors("position_sigma", &ForeignBead::uncertainty);
    for (std::size_t k = 0; k < has_.numbers.size(); ++k)
      x += data.add("Float64", has_.numbers[k].c_str(), 1, s.numbers[k]);
    x += "</PointData>\n<Verts>\n";  // ParaView draws points only where there are cells
    x += data.add("Int64", "connectivity", 1, indices);
    x += data.add("Int64", "offsets", 1, ends);
    return x + "</Verts>\n" + tail(data);
  }

  std::filesystem::path part_;
  ForeignColumns has_;
  WriteOptions options_;
  std::string beads_, contacts_;  ///< entries of the lists
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
        -> std::unique_ptr<ForeignWriter> { return std::make_unique<VtkWriter>(part, options); },
    .folder = true,
    .numbers = true};

}  // namespace twincell
