#include "tess/patch_mesh.h"

#include <tbb/parallel_for.h>

#include <algorithm>
#include <map>
#include <mutex>
#include <optional>

#include "tess/patch_bounds.h"

namespace iso {
namespace {

// Where bounds are only told, not kept, they are sharpened to this, times the largest distance that is reached.
constexpr double kSharp = 1.1;

constexpr std::uint32_t kNone = 0xffffffffu;

// ---- tables, one for each basis and levels -------------------------------------------------------------------------------

class TableStore {
 public:
  explicit TableStore(Strategy strategy) : strategy_(strategy) {}

  const PatternTables& of(const PatchBasis& basis, PatternLevels levels) {
    // Sides that are all as the inside is are one case.
    if (std::all_of(levels.of_side.begin(), levels.of_side.end(), [&](int l) { return l == levels.inner; })) levels.of_side.clear();
    const std::scoped_lock lock(mutex_);
    auto& known = tables_[Key{static_cast<int>(basis.kind), basis.sides, basis.degree, static_cast<int>(basis.parameters), levels}];
    if (!known) known = std::make_unique<PatternTables>(basis, strategy_, levels);
    return *known;
  }

  // Of the tables that are in use.
  void count(PatchMesh& mesh, const std::vector<const PatternTables*>& used) const {
    for (const auto& [key, tables] : tables_) {
      if (std::find(used.begin(), used.end(), tables.get()) == used.end()) continue;
      ++mesh.tables;
      mesh.table_bytes += tables->at_points.bytes();
    }
  }

 private:
  using Key = std::tuple<int, int, int, int, PatternLevels>;
  Strategy strategy_;
  std::mutex mutex_;
  std::map<Key, std::unique_ptr<PatternTables>> tables_;
};

// ---- levels ----------------------------------------------------------------------------------------------------------------

class Levels {
 public:
  Levels(const Part& part, const PartPatches& patches, const PatchSides& sides, const PatchMeshOptions& options, TableStore& store)
      : part_(part), patches_(patches), sides_(sides), options_(options), store_(store), inner_(patches.patches.size(), 1) {}

  std::span<const Face> charts(std::size_t p) const {
    return {&part_.faces[patches_.first_face[p]], static_cast<std::size_t>(patches_.patches[p].basis.sides)};
  }
  std::vector<FaceShape> shapes(std::size_t p, double tolerance) const {
    std::vector<FaceShape> all;
    for (const Face& face : charts(p)) all.emplace_back(face, tolerance);
    return all;
  }

  // The levels of each patch; those of a shared side are the largest of its patches' own.
  std::vector<PatternLevels> agreed() const {
    std::vector<int> of_side(sides_.sides.size(), 1);
    for (std::size_t p = 0; p < inner_.size(); ++p)
      for (const PatchSides::Use& use : sides_.of_patch[p]) {
        int& level = of_side[static_cast<std::size_t>(use.side)];
        level = std::max(level, inner_[p]);
      }
    std::vector<PatternLevels> all;
    for (std::size_t p = 0; p < inner_.size(); ++p) {
      all.push_back({inner_[p], {}});
      for (const PatchSides::Use& use : sides_.of_patch[p]) all.back().of_side.push_back(of_side[static_cast<std::size_t>(use.side)]);
    }
    return all;
  }

  void set(int level) { std::fill(inner_.begin(), inner_.end(), level); }

  // The smallest for the distance, each patch by itself; then more where the neighbours' sides ask for it. Returns how often.
  int search(const std::vector<std::vector<FaceShape>>& shapes) {
    tbb::parallel_for(std::size_t{0}, inner_.size(), [&](std::size_t p) { inner_[p] = smallest(p, shapes[p]); });
    int rounds = 1;
    for (bool raised = true; raised; ++rounds) {
      raised = false;
      const std::vector<PatternLevels> levels = agreed();
      std::vector<char> fails(inner_.size(), 0);
      tbb::parallel_for(std::size_t{0}, inner_.size(), [&](std::size_t p) {
        const bool even = std::all_of(levels[p].of_side.begin(), levels[p].of_side.end(), [&](int l) { return l == inner_[p]; });
        fails[p] = !even && inner_[p] < options_.most && !keeps(p, levels[p], shapes[p]);
      });
      for (std::size_t p = 0; p < inner_.size(); ++p)
        if (fails[p]) ++inner_[p], raised = true;
    }
    return rounds - 1;
  }

 private:
  bool keeps(std::size_t p, const PatternLevels& levels, const std::vector<FaceShape>& shapes) const {
    const PatternTables& tables = store_.of(patches_.patches[p].basis, levels);
    const std::vector<Vec3> places = places_of(tables, patches_.patches[p]);
    return PatchBounds(tables, places).within(shapes, options_.distance);
  }

  int smallest(std::size_t p, const std::vector<FaceShape>& shapes) const {
    int high = 1, low = 0;  // low is not enough
    while (high < options_.most && !keeps(p, {high, {}}, shapes)) low = high, high = std::min(2 * high, options_.most);
    while (high - low > 1) {
      const int middle = (low + high) / 2;
      (keeps(p, {middle, {}}, shapes) ? high : low) = middle;
    }
    return high;
  }

  const Part& part_;
  const PartPatches& patches_;
  const PatchSides& sides_;
  const PatchMeshOptions& options_;
  TableStore& store_;
  std::vector<int> inner_;
};

// ---- the mesh --------------------------------------------------------------------------------------------------------------

// A patch on its pattern: places of the points and then of the cuts, normals, and which points of the part they are.
struct PatchPlaces {
  const PatternTables* tables = nullptr;
  std::vector<Vec3> places, normals;
  std::vector<std::uint32_t> point;
  std::vector<double> bound;  // of its charts
};

PatchPlaces placed(const PatternTables& tables, const NSidedPatch& patch, std::span<const Face> charts) {
  PatchPlaces out{&tables, {}, {}, {}, {}};
  const auto take = [&](const CoordinateTable& table, auto place_at) {
    std::size_t i = 0;
    for (const CoordinateTable::At& at : table.evaluate(patch.points, patch.weights)) {
      const ChartPlace& place = place_at(i++);
      const Face& face = charts[static_cast<std::size_t>(place.corner)];
      const Vec3 n = glm::cross(at.Ss, at.St);
      constexpr double kLeastSine = 1e-6;
      const double area = glm::length(n);
      const bool regular = area > kLeastSine * glm::length(at.Ss) * glm::length(at.St);
      const Vec3 unit = regular ? n / area : unit_normal(face.surface, place.st, face.domain);
      out.places.push_back(at.S);
      out.normals.push_back(face.reversed ? -unit : unit);
    }
  };
  take(tables.at_points, [&](std::size_t i) -> const ChartPlace& { return tables.pattern.places[i]; });
  take(tables.at_cuts, [&](std::size_t i) -> const ChartPlace& { return tables.cuts.points[i].place; });
  return out;
}

class Assembler {
 public:
  Assembler(const Part& part, const PartPatches& patches, const PatchSides& sides, PatchMesh& out)
      : part_(part), patches_(patches), sides_(sides), out_(out), corner_(static_cast<std::size_t>(sides.corners), kNone) {
    of_side_.resize(sides.sides.size());
  }

  // Numbers the points of a patch; patches in order.
  void number(std::size_t p, PatchPlaces& patch) {
    const DomainPattern& pattern = patch.tables->pattern;
    patch.point.assign(patch.places.size(), kNone);
    std::vector<bool> inside(pattern.points.size(), true);
    for (std::size_t k = 0; k < pattern.of_side.size(); ++k) {
      for (const std::uint32_t i : pattern.of_side[k]) inside[i] = false;
      number_side(p, k, patch);
    }
    for (std::uint32_t i = 0; i < pattern.points.size(); ++i) {
      const ChartPlace& place = pattern.places[i];
      if (patch.point[i] == kNone) patch.point[i] = add_point(patch.places[i]);
      const auto face = static_cast<int>(patches_.first_face[p]) + place.corner;
      SurfacePlace& known = out_.places[patch.point[i]];
      if (known.face < 0) known = {face, place.st, inside[i]};
      double& offset = out_.made.faces[static_cast<std::size_t>(face)].offset;
      offset = std::max(offset, glm::length(out_.made.mesh.points[patch.point[i]] - patch.places[i]));
    }
  }

  // The triangles of a patch, face by face; all points are numbered.
  void add_triangles(std::size_t p, const PatchPlaces& patch) {
    const PatternTables& t = *patch.tables;
    const std::size_t first = patches_.first_face[p];
    for (int k = 0; k < t.pattern.sides; ++k) {
      const std::size_t f = first + static_cast<std::size_t>(k);
      std::vector<std::uint32_t> node(patch.places.size(), kNone);
      for (std::size_t i = 0; i < t.pattern.triangles.size(); ++i) {
        if (t.cuts.home[i] != k) continue;
        if (collapsed(patch, t.pattern.triangles[i])) {
          ++out_.made.faces[f].collapsed;
          continue;
        }
        Triangle corners;
        for (std::size_t c = 0; c < 3; ++c) corners[c] = node_of(t.pattern.triangles[i][c], k, patch, node);
        out_.made.mesh.triangles.push_back(part_.faces[f].reversed ? Triangle{corners[0], corners[2], corners[1]} : corners);
        ++out_.made.faces[f].triangles;
      }
      close_face(out_.made.mesh);
      out_.made.faces[f].bound = patch.bound[static_cast<std::size_t>(k)];
    }
    out_.quads += t.pattern.quads;
  }

  // The cut points follow those of the whole mesh.
  void start_cut() { out_.cut.points = out_.made.mesh.points; }

  void add_pieces(std::size_t p, PatchPlaces& patch) {
    const PatternTables& t = *patch.tables;
    for (std::size_t i = 0; i < t.cuts.points.size(); ++i) patch.point[t.pattern.points.size() + i] = number_cut(patch, t.cuts.points[i]);
    for (int k = 0; k < t.pattern.sides; ++k) {
      const bool reversed = part_.faces[patches_.first_face[p] + static_cast<std::size_t>(k)].reversed;
      std::vector<std::uint32_t> node(patch.places.size(), kNone);
      for (const PatternCuts::Piece& piece : t.cuts.pieces) {
        if (piece.corner != k || collapsed(patch, t.pattern.triangles[piece.triangle])) continue;
        Triangle corners;
        for (std::size_t c = 0; c < 3; ++c) {
          std::uint32_t& n = node[piece.points[c]];
          if (n == kNone) {
            n = static_cast<std::uint32_t>(out_.cut.nodes.size());
            out_.cut.nodes.push_back({patch.point[piece.points[c]], piece.st[c], patch.normals[piece.points[c]]});
          }
          corners[c] = n;
        }
        out_.cut.triangles.push_back(reversed ? Triangle{corners[0], corners[2], corners[1]} : corners);
      }
      close_face(out_.cut);
    }
  }

  void finish() { std::sort(out_.made.free_sides.begin(), out_.made.free_sides.end()); }

 private:
  std::uint32_t add_point(const Point3& place) {
    out_.made.mesh.points.push_back(place);
    out_.places.push_back({});
    return static_cast<std::uint32_t>(out_.made.mesh.points.size() - 1);
  }

  void number_side(std::size_t p, std::size_t k, PatchPlaces& patch) {
    const PatchSides::Use& use = sides_.of_patch[p][k];
    const PatchSides::Side& side = sides_.sides[static_cast<std::size_t>(use.side)];
    std::vector<std::uint32_t> row = patch.tables->pattern.of_side[k];
    if (use.backward) std::reverse(row.begin(), row.end());
    const std::size_t n = sides_.corner_of[p].size();
    for (const std::size_t corner : {(k + n - 1) % n, k}) {
      std::uint32_t& known = corner_[static_cast<std::size_t>(sides_.corner_of[p][corner])];
      const std::uint32_t i = patch.tables->pattern.of_side[k][corner == k ? row.size() - 1 : 0];
      if (known == kNone) known = add_point(patch.places[i]);
      patch.point[i] = known;
    }
    std::vector<std::uint32_t>& points = of_side_[static_cast<std::size_t>(use.side)];
    const bool is_new = points.empty();
    for (std::size_t i = 0; i < row.size(); ++i) {
      if (is_new) {
        const bool end = i == 0 || i + 1 == row.size();
        points.push_back(end ? patch.point[row[i]] : side.degenerate ? patch.point[row[0]] : add_point(patch.places[row[i]]));
        if (i > 0 && side.users == 1 && !side.degenerate)
          out_.made.free_sides.push_back({std::min(points[i - 1], points[i]), std::max(points[i - 1], points[i])});
      }
      patch.point[row[i]] = points[i];
    }
  }

  static bool collapsed(const PatchPlaces& patch, const std::array<std::uint32_t, 3>& t) {
    const std::uint32_t a = patch.point[t[0]], b = patch.point[t[1]], c = patch.point[t[2]];
    return a == b || b == c || c == a;
  }

  std::uint32_t node_of(std::uint32_t i, int chart, const PatchPlaces& patch, std::vector<std::uint32_t>& node) {
    if (node[i] != kNone) return node[i];
    const DomainPattern& pattern = patch.tables->pattern;
    const Vec2 uv = pattern.places[i].corner == chart ? pattern.places[i].st : place_in_chart(pattern.sides, chart, pattern.points[i]);
    node[i] = static_cast<std::uint32_t>(out_.made.mesh.nodes.size());
    out_.made.mesh.nodes.push_back({patch.point[i], uv, patch.normals[i]});
    return node[i];
  }

  // A cut lies on its triangle, where it is cut. On sides both patches have the same.
  std::uint32_t number_cut(const PatchPlaces& patch, const PatternCuts::Point& cut) {
    std::array<std::uint32_t, 3> between;
    for (std::size_t k = 0; k < 3; ++k) between[k] = patch.point[cut.between[k]];
    const auto make = [&] {
      Point3 p{0.0};
      for (std::size_t k = 0; k < 3; ++k) p += cut.weights[static_cast<int>(k)] * out_.cut.points[between[k]];
      out_.cut.points.push_back(p);
      return static_cast<std::uint32_t>(out_.cut.points.size() - 1);
    };
    if (!cut.on_side) return make();
    std::uint32_t& known = on_side_.try_emplace(std::minmax(between[0], between[1]), kNone).first->second;
    if (known == kNone) known = make();
    return known;
  }

  static void close_face(PartMesh& mesh) {
    mesh.first_node.push_back(static_cast<std::uint32_t>(mesh.nodes.size()));
    mesh.first_triangle.push_back(static_cast<std::uint32_t>(mesh.triangles.size()));
  }

  const Part& part_;
  const PartPatches& patches_;
  const PatchSides& sides_;
  PatchMesh& out_;
  std::vector<std::uint32_t> corner_;
  std::vector<std::vector<std::uint32_t>> of_side_;
  std::map<std::pair<std::uint32_t, std::uint32_t>, std::uint32_t> on_side_;
};

void assemble(const Part& part, const PartPatches& patches, const PatchSides& sides, std::vector<PatchPlaces>& all, PatchMesh& out) {
  Assembler assembler(part, patches, sides, out);
  for (std::size_t p = 0; p < all.size(); ++p) assembler.number(p, all[p]);
  for (std::size_t p = 0; p < all.size(); ++p) assembler.add_triangles(p, all[p]);
  assembler.start_cut();
  for (std::size_t p = 0; p < all.size(); ++p) assembler.add_pieces(p, all[p]);
  assembler.finish();
}

// The bounds of all patches: as sharp as what they keep, or as what they reach.
void prove(const Levels& levels, const PatchMeshOptions& options, std::vector<std::vector<FaceShape>>& shapes,
           std::vector<PatchPlaces>& all) {
  double aim = options.distance;
  if (!(aim > 0)) {
    std::vector<double> reached(all.size(), 0.0);
    tbb::parallel_for(std::size_t{0}, all.size(),
                      [&](std::size_t p) { reached[p] = PatchBounds(*all[p].tables, all[p].places).reached(levels.charts(p)); });
    for (const double r : reached) aim = std::max(aim, kSharp * r);
  }
  tbb::parallel_for(std::size_t{0}, all.size(), [&](std::size_t p) {
    if (shapes[p].empty()) shapes[p] = levels.shapes(p, aim);
    all[p].bound = PatchBounds(*all[p].tables, all[p].places).proven(shapes[p], aim);
  });
}

}  // namespace

PatchMesh mesh_patches(const Part& part, const PatchMeshOptions& options) {
  const Result<PartPatches> known = patches_of(part);
  ISO_CHECK(known && (options.level > 0 || options.distance > 0));
  const PartPatches& patches = *known;
  const PatchSides sides = sides_of(part, patches);
  TableStore store(options.strategy);
  Levels levels(part, patches, sides, options, store);
  std::vector<std::vector<FaceShape>> shapes(patches.patches.size());
  PatchMesh out;
  out.made.faces.resize(part.faces.size());
  if (options.level > 0) {
    levels.set(options.level);
  } else {
    tbb::parallel_for(std::size_t{0}, shapes.size(), [&](std::size_t p) { shapes[p] = levels.shapes(p, options.distance); });
    out.made.rounds = levels.search(shapes);
  }
  out.levels = levels.agreed();

  std::vector<PatchPlaces> all(patches.patches.size());
  std::vector<const PatternTables*> used;
  for (std::size_t p = 0; p < all.size(); ++p) used.push_back(&store.of(patches.patches[p].basis, out.levels[p]));
  tbb::parallel_for(std::size_t{0}, all.size(), [&](std::size_t p) { all[p] = placed(*used[p], patches.patches[p], levels.charts(p)); });
  prove(levels, options, shapes, all);
  assemble(part, patches, sides, all, out);
  store.count(out, used);
  for (FaceReport& face : out.made.faces)
    if (options.distance > 0 && !(face.bound <= options.distance)) face.unresolved = std::max(1, face.triangles);
  return out;
}

MeshReport verify(const Part& part, const PatchMesh& mesh) {
  const MakersNotes notes = notes_of(mesh.made);
  MeshReport report = verify(part, mesh.made.mesh, notes);
  // What is straight in the polygon is not quite so in its charts: pieces are disjoint and run the right way round there.
  PartMesh pieces = mesh.cut;
  for (std::size_t f = 0; f < part.faces.size(); ++f)
    for (std::uint32_t i = pieces.first_node[f]; i < pieces.first_node[f + 1]; ++i)
      pieces.nodes[i].uv = domain_point(std::get<PatchChart>(part.faces[f].surface).basis.sides, pieces.nodes[i].uv);
  const MeshReport cut = verify(part, pieces, notes);
  report.turned = cut.turned;
  report.overlapping = cut.overlapping;
  report.empty_faces = cut.empty_faces;
  return report;
}

}  // namespace iso
