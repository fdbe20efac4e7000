#include "patches/brep.h"

#include <array>
#include <sstream>

#include "patches/cells.h"
#include "patches/trim.h"

namespace iso {

void Model::report(Problem::Kind kind, std::string entity, std::string what) {
  for (Problem& p : problems)
    if (p.kind == kind && p.what == what) {
      ++p.count;
      return;
    }
  problems.push_back({kind, std::move(entity), std::move(what), 1});
}

// ---- gaps between the faces of an edge ---------------------------------------------------------------------------------

namespace {

// One use of an edge: a trim curve on its face.
struct EdgeUse {
  const Face* face;
  const TrimCurve* curve;

  double parameter(double share) const { return curve->t0 + share * (curve->t1 - curve->t0); }
  Point3 at(double t) const { return point(face->surface, jet(curve->curve, t).C); }
};

// Samples lie closer together toward the ends of an edge: there, where curves were fitted to meet at the vertices, they part within little.
constexpr int kGapSamples = 96;
double share_of_sample(std::size_t i) { return 0.5 - 0.5 * std::cos(kPi * static_cast<double>(i) / kGapSamples); }
constexpr double kWidestStep = 0.5 * kPi / kGapSamples;  // of those shares

std::vector<Point3> sampled(const EdgeUse& use) {
  std::vector<Point3> points;
  for (std::size_t i = 0; i <= kGapSamples; ++i) points.push_back(use.at(use.parameter(share_of_sample(i))));
  return points;
}

// Distance of p from the curve of a use: the nearest of its samples, then ever smaller steps around it.
double distance_to(const EdgeUse& use, const std::vector<Point3>& samples, const Point3& p) {
  std::size_t nearest = 0;
  for (std::size_t i = 1; i < samples.size(); ++i)
    if (glm::length(samples[i] - p) < glm::length(samples[nearest] - p)) nearest = i;
  double share = share_of_sample(nearest), least = glm::length(samples[nearest] - p), step = 0.5 * kWidestStep;
  for (int i = 0; i < 40; ++i, step *= 0.5)
    for (const double s : {share - step, share + step}) {
      if (s < 0 || s > 1) continue;
      if (const double d = glm::length(use.at(use.parameter(s)) - p); d < least) {
        least = d;
        share = s;
        break;
      }
    }
  return least;
}

// Both uses of an edge normally run with one parameter; where they do not, the nearest points count.
double gap_between(const EdgeUse& a, const EdgeUse& b, double file_tolerance) {
  constexpr double kRounding = 1e-14;  // of the coordinates: such a gap is none, and not looked at more closely
  double same = 0, size = 0;
  for (std::size_t i = 0; i <= kGapSamples; ++i) {
    const double t = a.parameter(share_of_sample(i));
    const Point3 at = a.at(t);
    same = std::max(same, glm::length(at - b.at(t)));
    size = std::max(size, glm::length(at));
  }
  if (same <= std::max(file_tolerance, kRounding * size)) return same;
  double gap = 0;
  const std::vector<Point3> sa = sampled(a), sb = sampled(b);
  for (const Point3& p : sa) gap = std::max(gap, distance_to(b, sb, p));
  for (const Point3& p : sb) gap = std::max(gap, distance_to(a, sa, p));
  return std::min(same, gap);
}

using UsesOfEdges = std::vector<std::vector<EdgeUse>>;

UsesOfEdges uses_of_edges(const Part& part) {
  UsesOfEdges uses(part.edges.size());
  for (const Face& face : part.faces)
    for (const TrimLoop& loop : face.loops)
      for (const TrimCurve& curve : loop.curves)
        if (curve.edge >= 0) uses[static_cast<std::size_t>(curve.edge)].push_back({&face, &curve});
  return uses;
}

// An edge of one face only may still lie along edges of others (files without topology): the gap is measured to the nearest of them, if
// every point of it has one within the file's tolerance.
void measure_free_edges(Part& part, const UsesOfEdges& uses) {
  struct Free {
    std::size_t edge;
    std::vector<Point3> samples;
    Box3 box;
  };
  std::vector<Free> free_edges;
  for (std::size_t e = 0; e < uses.size(); ++e) {
    if (uses[e].size() != 1 || part.edges[e].degenerate) continue;
    Free f{e, sampled(uses[e][0]), {}};
    for (const Point3& p : f.samples) f.box.include(p);
    f.box = f.box.inflated(part.edges[e].file_tolerance + 1e-3 * f.box.diagonal());
    free_edges.push_back(std::move(f));
  }
  for (const Free& f : free_edges) {
    Edge& edge = part.edges[f.edge];
    double gap = 0;
    for (std::size_t i = 0; i < f.samples.size() && gap <= edge.file_tolerance; i += 8) {
      double nearest = kInf;
      for (const Free& other : free_edges)
        if (other.edge != f.edge && other.box.contains(f.samples[i]) && nearest > 0.01 * edge.file_tolerance)
          nearest = std::min(nearest, distance_to(uses[other.edge][0], other.samples, f.samples[i]));
      gap = std::max(gap, nearest);
    }
    if (gap <= edge.file_tolerance) edge.gap = 1.1 * gap;
  }
}

// A gap is closed whole where two faces share the edge, even if the file claims a smaller tolerance, up to this share of the part's size.
constexpr double kLargestLyingGap = 1e-4;

void measure_gaps(Part& part) {
  const UsesOfEdges uses = uses_of_edges(part);
  for (std::size_t e = 0; e < uses.size(); ++e) {
    Edge& edge = part.edges[e];
    for (std::size_t i = 1; i < uses[e].size(); ++i)  // a little more than measured: the worst point lies between the samples
      edge.gap = std::max(edge.gap, 1.1 * gap_between(uses[e][0], uses[e][i], edge.file_tolerance));
  }
  measure_free_edges(part, uses);
  for (std::size_t e = 0; e < uses.size(); ++e) {
    Edge& edge = part.edges[e];
    const double most = uses[e].size() > 1 ? std::max(edge.file_tolerance, kLargestLyingGap * part.box.diagonal()) : edge.file_tolerance;
    edge.closing = edge.degenerate ? 0.0 : std::min(edge.gap, most);
  }
}

// Edges whose faces part by more than the file promises.
void report_loose_edges(Model& model) {
  int count = 0;
  double worst = 0;
  for (const Part& part : model.parts)
    for (const Edge& edge : part.edges)
      if (!edge.degenerate && edge.gap > 1.2 * edge.file_tolerance + 1e-9 * part.box.diagonal()) {
        ++count;
        worst = std::max(worst, edge.gap);
      }
  if (count == 0) return;
  std::ostringstream text;
  text.precision(3);
  text << count << " edges: their faces are farther apart than the file's tolerance, by up to " << worst;
  model.report(Problem::Kind::note, "edges", text.str());
}

}  // namespace

void finish(Model& model) {
  for (std::size_t k = 0; k < model.parts.size(); ++k) {
    Part& part = model.parts[k];
    Box3 rough;
    for (const Face& face : part.faces) rough.include(trimmed_box(face, TrimRegion(face, part.edges, 0.0)));
    const Vec3 origin = rough.empty() ? Vec3(0.0) : rough.middle();
    for (Face& face : part.faces) translate(face.surface, -origin);
    part.box = rough.empty() ? rough : Box3{rough.lo - origin, rough.hi - origin};
    for (Instance& instance : model.instances)
      if (instance.part == static_cast<int>(k)) instance.to_model.translation = instance.to_model.point(origin);
    measure_gaps(part);
  }
  report_loose_edges(model);
}

Box3 box_of(const Model& model) {
  Box3 box;
  for (const Instance& instance : model.instances) {
    const Part& part = model.parts[static_cast<std::size_t>(instance.part)];
    if (!part.box.empty()) box.include(transformed(instance.to_model, part.box));
  }
  return box;
}

}  // namespace iso
