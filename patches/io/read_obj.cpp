// Free-form surfaces of Alias|Wavefront OBJ: cstype [rat] bezier | bspline, with trim and hole loops of curv2 elements.
//
// Points are not premultiplied by their weights; u runs fastest in `surf`; weights count only under `rat`. The face's domain is the
// range s0..s1, t0..t1 of `surf`. Trim loops must close; a gap that is more than rounding is bridged by a line and reported.
// Other curve types (bmatrix, cardinal, taylor) and space curves cannot be used and are counted as dropped; so are polygons, unless patches
// are to be made of them (patches/control_mesh.h). A file without any surface is refused; so is malformed text, with its line.
//
// Reading is done in two steps, because a statement may refer to points that follow it: parse all elements, then build the faces.
#include "patches/io/obj_elements.h"
#include "patches/io/read_model.h"
#include "patches/io/text_input.h"

namespace iso {

namespace {

// Range ends and joints of curves count as equal within this share of the range: what printing with nine digits loses.
constexpr double kRounding = 1e-9;

class ObjBuilder {
 public:
  ObjBuilder(const std::string& path, ObjFile file, const ReadOptions& options) : path_(path), file_(std::move(file)), options_(options) {}

  Model build() {
    Model model;
    model.file = path_;
    model.format = "OBJ";
    refuse_without_surfaces();
    refuse_without_polygons();
    Part part = part_of_polygons(model);
    int number = 0;
    for (const ObjElement& s : file_.surfaces) {
      ++number;
      if (const std::string reason = unsupported(s); !reason.empty()) {
        model.problems.push_back({Problem::Kind::dropped, "surf of line " + std::to_string(s.line), reason, 1});
        continue;
      }
      Face face = build_face(s, model);
      face.name = s.name.empty() ? "surf " + std::to_string(number) : s.name;
      part.faces.push_back(std::move(face));
    }
    if (part.faces.empty() && file_.polygons.empty())
      fail(path_, file_.surfaces.front().line,
           "none of the " + std::to_string(file_.surfaces.size()) + " surfaces can be used: " + unsupported(file_.surfaces.front()));
    report_counted(model);

    Instance instance;
    instance.name = part.name;
    model.parts.push_back(std::move(part));
    model.instances.push_back(std::move(instance));
    return model;
  }

 private:
  void refuse_without_surfaces() const {
    if (!file_.surfaces.empty() || !file_.polygons.empty()) return;
    if (const auto f = file_.counted.find("f"); f != file_.counted.end())
      fail(path_, f->second.first_line,
           "found " + std::to_string(f->second.count) +
               " polygons and no free-form surface (surf), expected cstype bezier or bspline surfaces; --patches gregory makes patches of "
               "a control mesh's polygons");
    fail(path_, file_.lines, "found the end of the file, expected at least one free-form surface (surf)");
  }

  void refuse_without_polygons() const {
    if (options_.patches && options_.polygons_needed && file_.polygons.empty())
      fail(path_, file_.surfaces.front().line,
           "patches are made of control meshes (--patches), expected polygons (f), found " + std::to_string(file_.surfaces.size()) +
               " free-form surface(s) (surf) alone; they need no such option");
  }

  // The patches of the control mesh, if they are wanted.
  Part part_of_polygons(Model& model) const {
    if (file_.polygons.empty()) return part_of_patches(stem_of(path_), {});
    ControlMesh mesh;
    for (const Vec4& v : file_.vertices) mesh.points.emplace_back(v);
    for (const ObjPolygon& polygon : file_.polygons) {
      ControlPolygon p{.corners = {}, .normals = {}, .place = "line " + std::to_string(polygon.line), .name = polygon.name};
      for (const long i : polygon.points) p.corners.push_back(static_cast<int>(checked(polygon, i, file_.vertices.size(), "vertex")));
      for (const long i : polygon.normals)
        p.normals.push_back(file_.normals[static_cast<std::size_t>(checked(polygon, i, file_.normals.size(), "normal"))]);
      mesh.polygons.push_back(std::move(p));
    }
    MeshOfPatches made = patches_of_mesh(mesh, options_.patches.value_or(MeshPatches::gregory));
    model.problems.insert(model.problems.end(), made.problems.begin(), made.problems.end());
    return part_of_patches(stem_of(path_), made.patches);
  }

  long checked(const ObjPolygon& polygon, long index, std::size_t count, const std::string& what) const {
    if (index >= static_cast<long>(count))
      fail(path_, polygon.line, "f refers to " + what + " " + std::to_string(index + 1) + "; the file has " + std::to_string(count));
    return index;
  }

  // Why a surface cannot be used, or nothing.
  std::string unsupported(const ObjElement& s) const {
    if (!s.attributes.supported()) return "cstype " + s.attributes.type + " is not supported";
    for (const ObjLoop& l : s.loops)
      for (const ObjLoopPiece& piece : l.pieces)
        if (piece.curve < long(file_.trim_curves.size()) && !file_.trim_curves[std::size_t(piece.curve)].attributes.supported())
          return "a trim curve is of cstype " + file_.trim_curves[std::size_t(piece.curve)].attributes.type + ", which is not supported";
    return {};
  }

  void report_counted(Model& model) const {
    using Kind = Problem::Kind;
    struct Row {
      const char* key;
      Kind kind;
      const char* what;
    };
    static constexpr Row kRows[] = {
        {"f", Kind::dropped, "polygons (f); --patches makes patches of them"},
        {"l", Kind::dropped, "polylines (l)"},
        {"p", Kind::dropped, "points (p)"},
        {"curv", Kind::dropped, "space curves (curv)"},
        {"call", Kind::dropped, "calls of other files (call)"},
        {"csh", Kind::dropped, "shell commands (csh); never run"},
        {"bsp", Kind::dropped, "superseded surfaces (bsp)"},
        {"bzp", Kind::dropped, "superseded surfaces (bzp)"},
        {"cdc", Kind::dropped, "superseded curves (cdc)"},
        {"cdp", Kind::dropped, "superseded surfaces (cdp)"},
        {"sp", Kind::note, "special points (sp) change no surface and are not used"},
        {"scrv", Kind::note, "special curves (scrv) change no surface and are not used"},
        {"con", Kind::note, "connections between surfaces (con) are not used"},
        {"usemtl", Kind::note, "materials (usemtl) are not used"},
        {"t", Kind::note, "tags of subdivision surfaces (t: creases, corners, holes) are not used"},
        {"", Kind::dropped, "statements that are not known"},
    };
    int other = 0, other_line = 0;
    for (const auto& [key, c] : file_.counted) {
      const std::string place = "line " + std::to_string(c.first_line);
      const auto row = std::find_if(std::begin(kRows), std::end(kRows), [k = key](const Row& r) { return k == r.key; });
      if (row == std::end(kRows)) {
        other += c.count;
        other_line = other_line == 0 ? c.first_line : std::min(other_line, c.first_line);
        continue;
      }
      model.problems.push_back(
          {row->kind, place, row->what + (key.empty() ? ", from " + file_.first_unknown + " on" : std::string()), c.count});
    }
    if (other > 0)
      model.problems.push_back(
          {Kind::note, "line " + std::to_string(other_line), "display settings (mtllib, lod, ctech, stech, ...) are not used", other});
  }

  Face build_face(const ObjElement& e, Model& model) {
    Face face;
    NurbsSurface s = build_surface(e);
    const Range u = domain_of(e, s.knots_u, s.degree_u, e.u, "s0 s1"), v = domain_of(e, s.knots_v, s.degree_v, e.v, "t0 t1");
    face.domain = {{u.lo, v.lo}, {u.hi, v.hi}};
    face.surface = std::move(s);
    if (const std::string problem = problem_of(face.surface); !problem.empty()) fail(path_, e.line, "surf: " + problem);

    // Holes alone have the border of the domain around them.
    bool outer = false;
    for (const ObjLoop& l : e.loops) outer = outer || !l.hole;
    if (!e.loops.empty() && !outer) face.loops.push_back(border(face.domain));
    Box2 reach;  // of the outer loops
    for (const ObjLoop& l : e.loops) {
      face.loops.push_back(build_loop(l, face.domain, model));
      if (!l.hole) reach.include(box_of(face.loops.back()));
    }

    // The face lies inside its outer loops: what is left of the domain beyond them only makes boxes large.
    if (outer) {
      reach = reach.inflated(kRounding * face.domain.diagonal());
      const Box2 both{glm::max(face.domain.lo, reach.lo), glm::min(face.domain.hi, reach.hi)};
      if (both.empty()) fail(path_, e.line, "surf: the trim loops lie outside of its range");
      face.domain = both;
    }
    return face;
  }

  // The box of the control points of a loop, which holds the loop.
  static Box2 box_of(const TrimLoop& loop) {
    Box2 box;
    for (const TrimCurve& c : loop.curves)
      for (const BezierSpan<Vec2>& span : bezier_spans(c.curve, std::min(c.t0, c.t1), std::max(c.t0, c.t1)))
        for (const Vec3& h : span.points) box.include(project(h));
    return box;
  }

  NurbsSurface build_surface(const ObjElement& e) const {
    NurbsSurface s;
    s.degree_u = e.attributes.degree_u;
    s.degree_v = e.attributes.degree_v;
    if (s.degree_u < 1 || s.degree_v < 1) fail(path_, e.line, "surf needs two degrees (deg) before it");
    s.knots_u = knots(e, e.parm_u, s.degree_u, "parm u");
    s.knots_v = knots(e, e.parm_v, s.degree_v, "parm v");
    s.count_u = int(s.knots_u.size()) - s.degree_u - 1;
    s.count_v = int(s.knots_v.size()) - s.degree_v - 1;
    const std::size_t need = std::size_t(s.count_u) * std::size_t(s.count_v);
    if (e.points.size() != need)
      fail(path_, e.line,
           "surf has " + std::to_string(e.points.size()) + " control points, its degrees and parameters need " + std::to_string(s.count_u) +
               " x " + std::to_string(s.count_v) + " = " + std::to_string(need));

    // The file runs through u first, the surface stores v first.
    s.poles.resize(need);
    for (std::size_t k = 0; k < need; ++k) {
      const Vec4 p = point(e, e.points[k], file_.vertices, "vertex");
      const double w = e.attributes.rational ? p.w : 1;
      if (!(w > 0))
        fail(path_, e.line,
             "vertex " + std::to_string(e.points[k] + 1) + " has the weight " + std::to_string(w) + ", expected a positive one");
      const std::size_t i = k % std::size_t(s.count_u), j = k / std::size_t(s.count_u);
      s.poles[i * std::size_t(s.count_v) + j] = homogeneous(Vec3(p), w);
    }
    mark_closed(s);
    return s;
  }

  // A surface is closed where both ends are clamped and the first and last row of poles are the same.
  static void mark_closed(NurbsSurface& s) {
    const auto clamped = [](const std::vector<double>& k, int degree) {
      return k[0] == k[std::size_t(degree)] && k[k.size() - 1 - std::size_t(degree)] == k.back();
    };
    const auto pole = [&](int i, int j) { return s.poles[std::size_t(i) * std::size_t(s.count_v) + std::size_t(j)]; };
    s.closed_u = clamped(s.knots_u, s.degree_u);
    for (int j = 0; j < s.count_v; ++j) s.closed_u = s.closed_u && pole(0, j) == pole(s.count_u - 1, j);
    s.closed_v = clamped(s.knots_v, s.degree_v);
    for (int i = 0; i < s.count_u; ++i) s.closed_v = s.closed_v && pole(i, 0) == pole(i, s.count_v - 1);
  }

  // The knot vector: as it stands for B-splines; for Bezier pieces each breakpoint `degree` times, and once more at the ends.
  std::vector<double> knots(const ObjElement& e, const std::vector<double>& parm, int degree, const std::string& which) const {
    const bool bezier = e.attributes.type == "bezier";
    const std::size_t least = bezier ? 2 : std::size_t(2 * degree + 2);
    if (parm.size() < least)
      fail(path_, e.line,
           e.keyword + ": " + which + " has " + std::to_string(parm.size()) + " values, expected at least " + std::to_string(least));
    for (std::size_t i = 1; i < parm.size(); ++i)
      if (parm[i] < parm[i - 1] || (bezier && parm[i] == parm[i - 1]))
        fail(path_, e.line,
             e.keyword + ": " + which + ": value " + std::to_string(i + 1) + " of " + std::to_string(parm.size()) +
                 (bezier ? " is not larger than the one before it" : " is smaller than the one before it"));
    if (!bezier) return parm;
    std::vector<double> k(1, parm.front());
    for (const double t : parm) k.insert(k.end(), std::size_t(degree), t);
    k.push_back(parm.back());
    return k;
  }

  // The wanted range, which must lie in the domain of the knots; rounding in the file is forgiven.
  Range domain_of(const ObjElement& e, const std::vector<double>& k, int degree, const Range& wanted, const std::string& which) const {
    const Range full{k[std::size_t(degree)], k[k.size() - 1 - std::size_t(degree)]};
    const double slack = kRounding * full.width();
    if (wanted.lo < full.lo - slack || wanted.hi > full.hi + slack || !(full.lo < full.hi))
      fail(path_, e.line,
           e.keyword + ": the range " + which + " = " + text(wanted) + " is not inside the range of the knots, " + text(full));
    return {std::max(wanted.lo, full.lo), std::min(wanted.hi, full.hi)};
  }

  static std::string text(const Range& r) { return std::to_string(r.lo) + " to " + std::to_string(r.hi); }

  template <class P>
  const P& point(const ObjElement& e, long index, const std::vector<P>& points, const std::string& what) const {
    if (index < 0 || index >= long(points.size()))
      fail(path_, e.line,
           e.keyword + " refers to " + what + " " + std::to_string(index + 1) + "; the file has " + std::to_string(points.size()));
    return points[std::size_t(index)];
  }

  NurbsCurve<Vec2> build_curve(const ObjElement& e) const {
    NurbsCurve<Vec2> c;
    c.degree = e.attributes.degree_u;
    if (c.degree < 1) fail(path_, e.line, "curv2 needs a degree (deg) before it");
    c.knots = knots(e, e.parm_u, c.degree, "parm u");
    const std::size_t need = c.knots.size() - std::size_t(c.degree) - 1;
    if (e.points.size() != need)
      fail(path_, e.line,
           "curv2 has " + std::to_string(e.points.size()) + " points, its degree and parameters need " + std::to_string(need));
    for (const long i : e.points) {
      const Vec3 p = point(e, i, file_.parameter_vertices, "parameter vertex");
      const double w = e.attributes.rational ? p.z : 1;
      if (!(w > 0))
        fail(path_, e.line,
             "parameter vertex " + std::to_string(i + 1) + " has the weight " + std::to_string(w) + ", expected a positive one");
      c.poles.push_back(homogeneous(Vec2(p), w));
    }
    if (const std::string problem = problem_of(c); !problem.empty()) fail(path_, e.line, "curv2: " + problem);
    return c;
  }

  static TrimCurve straight(const UV& from, const UV& to) { return {Line<Vec2>{from, to - from}, 0, 1, -1}; }

  static TrimLoop border(const Box2& box) {
    const UV corners[4] = {box.lo, {box.hi.x, box.lo.y}, box.hi, {box.lo.x, box.hi.y}};
    TrimLoop loop;
    for (int i = 0; i < 4; ++i) loop.curves.push_back(straight(corners[i], corners[(i + 1) % 4]));
    return loop;
  }

  TrimLoop build_loop(const ObjLoop& l, const Box2& domain, Model& model) const {
    std::vector<TrimCurve> pieces;
    for (const ObjLoopPiece& piece : l.pieces) {
      if (piece.curve >= long(file_.trim_curves.size()))
        fail(path_, l.line,
             "found trim curve " + std::to_string(piece.curve + 1) + "; the file has " + std::to_string(file_.trim_curves.size()) +
                 " (curv2)");
      const NurbsCurve<Vec2> curve = build_curve(file_.trim_curves[std::size_t(piece.curve)]);
      pieces.push_back({curve, piece.t0, piece.t1, -1});
      clamp_range(l, curve, pieces.back());
    }

    // Bridge the gaps from each piece to the next, and report the largest.
    TrimLoop loop;
    double largest = 0;
    for (std::size_t i = 0; i < pieces.size(); ++i) {
      const TrimCurve& next = pieces[(i + 1) % pieces.size()];
      const UV from = jet(pieces[i].curve, pieces[i].t1).C, to = jet(next.curve, next.t0).C;
      const double gap = glm::length(to - from);
      loop.curves.push_back(pieces[i]);
      if (gap > kRounding * domain.diagonal()) loop.curves.push_back(straight(from, to));
      largest = std::max(largest, gap);
    }
    if (largest > kRounding * domain.diagonal())
      model.problems.push_back(
          {Problem::Kind::repaired, "line " + std::to_string(l.line),
           "a trim loop does not close; gaps of up to " + std::to_string(largest) + " in parameters are bridged by lines", 1});
    return loop;
  }

  // Start and end must lie in the curve's domain, up to rounding in the file, and differ.
  void clamp_range(const ObjLoop& l, const NurbsCurve<Vec2>& curve, TrimCurve& piece) const {
    const Range full{curve.knots[std::size_t(curve.degree)], curve.knots[curve.poles.size()]};
    const double slack = kRounding * full.width();
    for (double* t : {&piece.t0, &piece.t1}) {
      if (*t < full.lo - slack || *t > full.hi + slack)
        fail(path_, l.line, "found the curve parameter " + std::to_string(*t) + ", expected one inside the curve's range, " + text(full));
      *t = std::clamp(*t, full.lo, full.hi);
    }
    if (piece.t0 == piece.t1)
      fail(path_, l.line,
           "found a piece of a trim curve from " + std::to_string(piece.t0) + " to the same parameter, expected another end");
  }

  const std::string& path_;
  ObjFile file_;
  const ReadOptions& options_;
};

}  // namespace

Result<Model> read_obj(const std::string& path, const ReadOptions& options) {
  const auto text = read_text(path);
  if (!text) return text.error();
  try {
    const PolygonsOfObj polygons = options.patches ? PolygonsOfObj::read : PolygonsOfObj::counted;
    return ObjBuilder(path, parse_obj(path, *text, polygons), options).build();
  } catch (const Error& error) {
    return error;
  }
}

}  // namespace iso
