#include "patches/io/occt_face.h"

#include <fmt/format.h>

#include <BRep_Tool.hxx>
#include <Geom_ConicalSurface.hxx>
#include <Geom_Surface.hxx>
#include <Standard_ErrorHandler.hxx>
#include <Standard_Failure.hxx>
#include <TopExp.hxx>
#include <TopExp_Explorer.hxx>
#include <TopoDS.hxx>
#include <TopoDS_Iterator.hxx>
#include <unordered_map>

#include "patches/io/collapsed_side.h"
#include "patches/io/loops.h"
#include "patches/io/occt_surface.h"
#include "patches/io/occt_trim_curve.h"

namespace iso::occt {
namespace {

// A face is without area if its area is below this share of its squared outline: far below the finest file tolerances (1e-7 of 1e4).
constexpr double kNoArea = 1e-10;
// Trim curves that leave the surface's domain by more than this share of it are told.
constexpr double kOutsideDomain = 1e-3;
constexpr int kAreaSamples = 6;

struct Trouble {
  Problem::Kind kind;
  std::string what;
};

// What became of one face of the file.
struct Attempt {
  Face face;
  std::vector<Chain> chains;
  std::vector<TopoDS_Edge> edges;  // LoopPiece::tag counts these
  std::vector<Trouble> troubles;
  std::string failure;  // why it cannot be used, else empty

  void tell(Problem::Kind kind, std::string what) { troubles.push_back({kind, std::move(what)}); }
  bool is_collapsed(const LoopPiece& piece) const {
    return piece.tag >= 0 && BRep_Tool::Degenerated(edges[static_cast<size_t>(piece.tag)]);
  }
};

LoopPiece straight_piece(const UV& from, const UV& to, int tag) { return loop_piece({Line<Vec2>{from, to - from}, 0, 1, -1}, tag); }

// A collapsed side was made to fit the edges beside it; where one of them was projected anew, it is fitted again.
std::vector<LoopPiece> with_collapsed_sides_fitted(const std::vector<LoopPiece>& pieces, const std::vector<char>& reprojected,
                                                   const Attempt& attempt) {
  const size_t n = pieces.size();
  std::vector<LoopPiece> fitted;
  for (size_t i = 0; i < n; ++i) {
    const size_t before = (i + n - 1) % n, after = (i + 1) % n;
    if (attempt.is_collapsed(pieces[i]) && (reprojected[before] || reprojected[after]))
      fitted.push_back(straight_piece(pieces[before].end, pieces[after].start, pieces[i].tag));
    else
      fitted.push_back(pieces[i]);
  }
  return fitted;
}

// All uses of edges of one wire, in the wire's order. Edges inside the face (cracks) do not bound it.
std::vector<LoopPiece> pieces_of(const TopoDS_Shape& wire, const TopoDS_Face& face, const PlacedSurface& placed, Attempt& attempt) {
  std::vector<LoopPiece> pieces;
  std::vector<char> reprojected;
  for (TopoDS_Iterator it(wire); it.More(); it.Next()) {
    if (it.Value().ShapeType() != TopAbs_EDGE) continue;
    const TopoDS_Edge edge = TopoDS::Edge(it.Value());
    if (edge.Orientation() != TopAbs_FORWARD && edge.Orientation() != TopAbs_REVERSED) {
      attempt.tell(Problem::Kind::note, "an edge inside the face does not bound it: not used");
      continue;
    }
    auto use = trim_curve(edge, face, placed, [&](Problem::Kind kind, const std::string& what) { attempt.tell(kind, what); });
    if (!use) continue;
    LoopPiece piece = loop_piece(std::move(use->trim), static_cast<int>(attempt.edges.size()));
    if (!finite(piece.start) || !finite(piece.end)) {
      attempt.tell(Problem::Kind::repaired, "a trim curve is not finite: closed by a line");
      continue;
    }
    attempt.edges.push_back(edge);
    pieces.push_back(std::move(piece));
    reprojected.push_back(use->reprojected);
  }
  if (wire.Orientation() == TopAbs_REVERSED) {
    pieces = std::vector<LoopPiece>(pieces.rbegin(), pieces.rend());
    std::reverse(reprojected.begin(), reprojected.end());
  }
  return with_collapsed_sides_fitted(pieces, reprojected, attempt);
}

// The chains of all wires of the (forward) face; whether there was any wire with edges.
bool collect_chains(const TopoDS_Face& face, const PlacedSurface& placed, const Vec2& period, Attempt& attempt) {
  bool any_edge = false;
  std::vector<std::vector<LoopPiece>> wires;
  Box2 ends;
  for (TopoDS_Iterator it(face); it.More(); it.Next()) {
    if (it.Value().ShapeType() != TopAbs_WIRE) continue;
    any_edge = any_edge || TopExp_Explorer(it.Value(), TopAbs_EDGE).More();
    wires.push_back(pieces_of(it.Value(), face, placed, attempt));
    for (const LoopPiece& p : wires.back()) {
      ends.include(p.start);
      ends.include(p.end);
      ends.include(jet(p.trim.curve, 0.5 * (p.trim.t0 + p.trim.t1)).C);
    }
  }
  for (auto& wire : wires)
    for (Chain& chain : chains_of(std::move(wire), period, ends.size())) attempt.chains.push_back(std::move(chain));
  return any_edge;
}

double tolerance_of(const TopoDS_Edge& edge) {
  double tolerance = BRep_Tool::Tolerance(edge);
  for (TopExp_Explorer v(edge, TopAbs_VERTEX); v.More(); v.Next())
    tolerance = std::max(tolerance, BRep_Tool::Tolerance(TopoDS::Vertex(v.Current())));
  return tolerance;
}

// Tells joints that are open in space beyond the file's own tolerance; a loop is closed there by a straight line in (u, v).
void tell_gaps(Attempt& attempt) {
  double worst = 0;
  UV where{0.0};
  for (const Chain& chain : attempt.chains)
    for (size_t i = 0; i < chain.pieces.size(); ++i) {
      const Gap gap = gap_after(chain, i);
      if (gap.from == gap.to) continue;
      double allowed = kConfusion;
      for (const int tag : {chain.pieces[i].tag, chain.pieces[(i + 1) % chain.pieces.size()].tag})
        if (tag >= 0) allowed = std::max(allowed, tolerance_of(attempt.edges[static_cast<size_t>(tag)]));
      const double open = glm::length(point(attempt.face.surface, gap.to) - point(attempt.face.surface, gap.from));
      if (open > 2 * allowed && open > worst) worst = open, where = gap.from;
    }
  if (worst > 0)
    attempt.tell(Problem::Kind::repaired,
                 fmt::format("trim loop open by {:.2g} at uv ({:.6g}, {:.6g}), beyond the file's tolerance: closed by a line", worst,
                             where.x, where.y));
}

// The part of the box on the surface; directions in which the surface closes are not cut.
Box2 clipped(const Box2& box, const AnySurface& surface, Attempt& attempt) {
  const Box2 natural = natural_domain(surface);
  const Vec2 period = periods(surface);
  Box2 out = box;
  double outside = 0;
  for (int c = 0; c < 2; ++c) {
    if (period[c] > 0) continue;
    const double width = natural.hi[c] - natural.lo[c];
    outside = std::max({outside, (natural.lo[c] - box.lo[c]) / width, (box.hi[c] - natural.hi[c]) / width});
    out.lo[c] = std::clamp(box.lo[c], natural.lo[c], natural.hi[c]);
    out.hi[c] = std::clamp(box.hi[c], natural.lo[c], natural.hi[c]);
  }
  if (outside > kOutsideDomain)
    attempt.tell(Problem::Kind::note, fmt::format("trim curves leave the surface by {:.2g} of its domain: cut there", outside));
  return out;
}

// An estimate of the area and the length of the outline; both only to recognise faces without area.
bool has_area(const Attempt& attempt) {
  const Face& face = attempt.face;
  double area = attempt.chains.empty() ? face.domain.size().x * face.domain.size().y : 0, outline = 0, stretch = 0;
  for (const Chain& chain : attempt.chains) {
    const auto polygon = polygon_of(chain);
    area = std::max(area, std::abs(signed_area(polygon)));
    for (size_t i = 0, j = polygon.size() - 1; i < polygon.size(); j = i++)
      outline += glm::length(point(face.surface, polygon[i]) - point(face.surface, polygon[j]));
  }
  for (int i = 0; i < kAreaSamples; ++i)
    for (int j = 0; j < kAreaSamples; ++j) {
      const Jet2 s = jet2(face.surface, face.domain.lo + face.domain.size() * Vec2(i + 0.5, j + 0.5) / double(kAreaSamples));
      stretch = std::max(stretch, glm::length(glm::cross(s.Su, s.Sv)));
      if (attempt.chains.empty())
        outline = std::max(outline, glm::length(s.Su) * face.domain.size().x + glm::length(s.Sv) * face.domain.size().y);
    }
  return area * stretch > kNoArea * outline * outline;
}

void check_directions(Attempt& attempt) {
  const auto wrong = wrongly_directed(attempt.chains);
  for (const size_t i : wrong) turn(attempt.chains[i]);
  if (!wrong.empty()) attempt.tell(Problem::Kind::repaired, "trim loop in the wrong direction: turned");
  for (const Chain& chain : attempt.chains)
    if (chain.turned > 0) attempt.tell(Problem::Kind::repaired, "edge in the wrong direction inside its loop: turned");
}

// Where a chain that goes around the surface without a partner can be closed: a pole, an apex or an end on the material's side.
std::optional<double> closing_line(const Chain& chain, const Handle(Geom_Surface) & surface, const Vec2& period) {
  const auto [across, sign] = material_side(chain);
  if (period[across] > 0) return std::nullopt;
  const double here = box_of(std::vector<Chain>{chain}).middle()[across];
  const Box2 natural = bounds_of(surface);
  double line = sign > 0 ? natural.hi[across] : natural.lo[across];
  if (const auto cone = Handle(Geom_ConicalSurface)::DownCast(surface); !cone.IsNull() && across == 1)
    line = -cone->RefRadius() / std::sin(cone->SemiAngle());
  if (!finite(line) || (line - here) * sign < 0) return std::nullopt;
  return line;
}

// The file may leave out seams: chains that go around the surface are joined in pairs or closed at a pole. False if one stays open.
bool close_windings(const Handle(Geom_Surface) & surface, const Vec2& period, int& next_seam, Attempt& attempt) {
  const auto open = [](const Chain& chain) { return chain.winding != Vec2(0.0); };
  if (std::none_of(attempt.chains.begin(), attempt.chains.end(), open)) return true;
  join_bands(attempt.chains, period, Partner::on_material_side, next_seam);
  for (Chain& chain : attempt.chains)
    if (open(chain))
      if (const auto line = closing_line(chain, surface, period)) close_at(chain, *line, next_seam);
  join_bands(attempt.chains, period, Partner::anywhere, next_seam);
  if (std::any_of(attempt.chains.begin(), attempt.chains.end(), open)) return false;
  attempt.tell(Problem::Kind::repaired, "trim loops go around the surface without a seam: seam added");
  return true;
}

// On a closed surface, outlines that run the wrong way bound everything else: the whole surface gets an outline, they are its holes.
void add_outline(const Vec2& period, const Box2& natural, int& next_seam, Attempt& attempt) {
  if (period == Vec2(0.0) || !finite(natural.lo) || !finite(natural.hi)) return;
  if (attempt.chains.empty() || wrongly_directed(attempt.chains).size() != attempt.chains.size()) return;
  const Box2 holes = box_of(attempt.chains);
  Box2 whole = natural;
  for (int c = 0; c < 2; ++c)
    if (period[c] > 0 && (holes.lo[c] < natural.lo[c] || holes.hi[c] > natural.hi[c])) {
      whole.lo[c] = holes.middle()[c] - period[c] / 2;
      whole.hi[c] = whole.lo[c] + period[c];
    }
  attempt.chains.insert(attempt.chains.begin(), outline_of(whole, period, next_seam));
  attempt.tell(Problem::Kind::repaired, "trim loops bound only holes: the outline of the whole surface added");
}

// The loops of the face closed, in one window of periods. False if they cannot be closed.
bool close_loops(const Handle(Geom_Surface) & surface, const Vec2& period, Attempt& attempt) {
  int next_seam = kClosingTag - 1;
  if (!close_windings(surface, period, next_seam, attempt)) return false;
  const Box2 natural = bounds_of(surface);
  align_periods(attempt.chains, period, natural);
  add_outline(period, natural, next_seam, attempt);
  return true;
}

void set_surface(const PlacedSurface& placed, const Box2& needed, Attempt& attempt) {
  auto converted = convert_surface(placed.surface, needed);
  if (!converted) {
    attempt.failure = fmt::format("a surface of type {} cannot be used", placed.surface->DynamicType()->Name());
    return;
  }
  attempt.failure = problem_of(converted->surface);
  attempt.face.surface = std::move(converted->surface);
  attempt.face.approximation_error = converted->error;
  if (!converted->original.empty())
    attempt.tell(Problem::Kind::approximated, fmt::format("{} as B-spline, {:.2g} off", converted->original, converted->error));
}

// Whether the surface collapses a trim curve to a point (a pole, an apex), to within Open CASCADE's confusion.
bool is_point(const AnySurface& surface, const LoopPiece& piece) {
  constexpr int kSamples = 8;
  const Point3 start = point(surface, piece.start);
  for (int i = 1; i <= kSamples; ++i)
    if (glm::length(point(surface, jet(piece.trim.curve, piece.trim.t0 + (piece.trim.t1 - piece.trim.t0) * i / kSamples).C) - start) >
        kConfusion)
      return false;
  return true;
}

LoopPiece piece_along(const BorderWay& way, int tag) {
  NurbsCurve<Vec2> n;
  n.degree = 1;
  const double last = static_cast<double>(way.points.size()) - 1;
  n.knots.push_back(0);
  for (size_t i = 0; i < way.points.size(); ++i) {
    n.knots.push_back(static_cast<double>(i));
    n.poles.push_back(homogeneous(way.points[i], 1.0));
  }
  n.knots.push_back(last);
  return loop_piece({std::move(n), 0, last, -1}, tag);
}

// Collapsed sides, and joints that are open only in (u, v), follow the border of the surface where a straight line would cut across it.
void follow_collapsed_sides(Attempt& attempt) {
  double worst = 0;
  const auto along_border = [&](const UV& from, const UV& to) {
    const auto way = border_way(attempt.face.surface, from, to, kConfusion);
    if (way) worst = std::max(worst, way->straight);
    return way;
  };
  for (Chain& chain : attempt.chains) {
    std::vector<LoopPiece> pieces;
    for (size_t i = 0; i < chain.pieces.size(); ++i) {
      const LoopPiece& piece = chain.pieces[i];
      const bool crosses = attempt.is_collapsed(piece) && !is_point(attempt.face.surface, piece);
      const auto around = crosses ? along_border(piece.start, piece.end) : std::nullopt;
      pieces.push_back(around ? piece_along(*around, piece.tag) : piece);
      if (const Gap gap = gap_after(chain, i); gap.from != gap.to)
        if (const auto way = along_border(gap.from, gap.to)) pieces.push_back(piece_along(*way, kClosingTag));
    }
    chain.pieces = std::move(pieces);
  }
  if (worst > 0)
    attempt.tell(Problem::Kind::repaired,
                 fmt::format("a line across the surface, up to {:.2g} off, stood for collapsed sides: the border followed", worst));
}

Attempt attempt_face(const TopoDS_Face& face) {
  Attempt attempt;
  const TopoDS_Face forward = TopoDS::Face(face.Oriented(TopAbs_FORWARD));
  const PlacedSurface placed = placed_surface(forward);
  if (placed.surface.IsNull()) {
    attempt.failure = "it has no surface";
    return attempt;
  }
  attempt.face.reversed = (face.Orientation() == TopAbs_REVERSED) != placed.mirrored;
  const Handle(Geom_Surface) surface = untrimmed(placed.surface);
  const Vec2 period = periods_of(surface);
  const bool any_edge = collect_chains(forward, placed, period, attempt);
  if (any_edge && attempt.chains.empty()) {
    attempt.failure = "none of its trim curves can be used";
    return attempt;
  }
  if (!close_loops(surface, period, attempt)) {
    attempt.failure = "a trim loop goes around the surface and nothing closes it";
    return attempt;
  }
  const Box2 box = any_edge ? box_of(attempt.chains) : bounds_of(placed.surface);
  if (box.empty() || !finite(box.lo) || !finite(box.hi)) {
    attempt.failure = any_edge ? "its trim curves are not finite" : "it has no trim loops and its surface is unbounded";
    return attempt;
  }
  set_surface(placed, box, attempt);
  if (!attempt.failure.empty()) return attempt;
  follow_collapsed_sides(attempt);
  attempt.face.domain = clipped(any_edge ? box_of(attempt.chains) : box, attempt.face.surface, attempt);
  if (!has_area(attempt)) attempt.failure = "it has no area";
  return attempt;
}

// Moves the finished face into the part, numbers its edges and tells its troubles.
void accept(Attempt& attempt, int solid, PartInProgress& part, const Report& report) {
  check_directions(attempt);
  tell_gaps(attempt);
  for (Chain& chain : attempt.chains) close_jumps(chain);
  std::unordered_map<int, int> seams;  // tags of joined bands to numbers of edges
  for (Chain& chain : attempt.chains) {
    TrimLoop loop;
    for (LoopPiece& piece : chain.pieces) {
      if (piece.tag >= 0) {
        piece.trim.edge = part.edge_number(attempt.edges[static_cast<size_t>(piece.tag)]);
      } else if (piece.tag == kClosingTag) {
        piece.trim.edge = static_cast<int>(part.part.edges.size());
        part.part.edges.push_back({0, is_point(attempt.face.surface, piece), kConfusion, 0});
      } else {
        const auto [seam, is_new] = seams.try_emplace(piece.tag, static_cast<int>(part.part.edges.size()));
        if (is_new) part.part.edges.emplace_back();
        piece.trim.edge = seam->second;
      }
      ++part.part.edges[static_cast<size_t>(piece.trim.edge)].uses;
      loop.curves.push_back(std::move(piece.trim));
    }
    attempt.face.loops.push_back(std::move(loop));
  }
  attempt.face.solid = solid;
  for (const Trouble& t : attempt.troubles) report(t.kind, t.what);
  part.part.faces.push_back(std::move(attempt.face));
}

}  // namespace

int PartInProgress::edge_number(const TopoDS_Edge& edge) {
  if (const Standard_Integer* known = edge_numbers.Seek(edge)) return *known;
  const int number = static_cast<int>(part.edges.size());
  edge_numbers.Bind(edge, number);
  part.edges.push_back({0, bool(BRep_Tool::Degenerated(edge)), BRep_Tool::Tolerance(edge), 0});
  return number;
}

bool add_face(const TopoDS_Face& face, int solid, PartInProgress& part, const Report& report) {
  Attempt attempt;
  try {
    OCC_CATCH_SIGNALS
    attempt = attempt_face(face);
  } catch (const Standard_Failure& failure) {
    report(Problem::Kind::dropped,
           fmt::format("Open CASCADE failed on it: {} {}", failure.DynamicType()->Name(), failure.GetMessageString()));
    return false;
  }
  if (!attempt.failure.empty()) {
    report(Problem::Kind::dropped, attempt.failure);
    return false;
  }
  accept(attempt, solid, part, report);
  return true;
}

}  // namespace iso::occt
