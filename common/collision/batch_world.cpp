// SPDX-License-Identifier: Apache-2.0
#include "common/collision/batch_world.hpp"

#include <algorithm>
#include <cmath>
#include <cstring>
#include <limits>
#include <map>
#include <new>

namespace handsel {
namespace {

constexpr double kRoundingRatio = 2e-5;  // max position error of a sphere / robot reach [m/m]
constexpr int kRowsFrom = 4;             // min number of solids that are also checked side by side
constexpr double kMaxTurn = BatchChain::kMaxTurn;

bool primitive(const Shape& shape) { return !std::holds_alternative<MeshPtr>(shape); }

}  // namespace

BatchWorld::BatchWorld(const RobotModel& robot)
    : robot_(robot), kernels_(&detail::simd_kernels()) {}

BatchWorld::Floats BatchWorld::floats(std::size_t count) {
  auto* memory = static_cast<float*>(
      ::operator new[](std::max<std::size_t>(count, 16) * sizeof(float), std::align_val_t(64)));
  std::fill_n(memory, std::max<std::size_t>(count, 16), 0.0f);
  return Floats(memory);
}

int BatchWorld::add_tree(const SphereCover& cover, const Pose& T_body_shape, int body) {
  const int first = static_cast<int>(nodes_.size());
  for (const CoverNode& node : cover.nodes) {
    const Eigen::Vector3f c = (T_body_shape * node.center).cast<float>();
    nodes_.push_back({c.x(), c.y(), c.z(), static_cast<float>(node.radius),
                      node.children > 0 ? node.first_child + first : 0, node.children, body, 0});
  }
  return first;
}

/// Adds a sphere that encloses trees; their roots become its children.
int BatchWorld::add_root(const std::vector<int>& roots, int body) {
  if (roots.size() == 1) return roots[0];
  const int root = static_cast<int>(nodes_.size());
  Eigen::Vector3f center = Eigen::Vector3f::Zero();
  float radius = 0;
  const auto at = [&](int i) {
    return Eigen::Vector3f(nodes_[static_cast<std::size_t>(i)].x,
                           nodes_[static_cast<std::size_t>(i)].y,
                           nodes_[static_cast<std::size_t>(i)].z);
  };
  for (int i : roots) center += at(i) / static_cast<float>(roots.size());
  const auto farthest = [&] {
    int best = roots[0];
    float max_distance = -1;
    for (int i : roots)
      if (const float d = (at(i) - center).norm() + nodes_[static_cast<std::size_t>(i)].radius;
          d > max_distance) {
        max_distance = d;
        best = i;
      }
    radius = max_distance;
    return best;
  };
  for (int k = 1; k <= 32; ++k) center += (at(farthest()) - center) / static_cast<float>(k + 1);
  farthest();
  nodes_.push_back({center.x(), center.y(), center.z(), radius, root + 1,
                    static_cast<std::int32_t>(roots.size()), body, 0});
  for (int i : roots) nodes_.push_back(nodes_[static_cast<std::size_t>(i)]);
  return root;
}

void BatchWorld::place_trees(const std::vector<Body>& bodies) {
  nodes_.clear();
  parts_.clear();
  std::map<std::pair<int, std::uint8_t>, std::size_t> part_of;
  for (std::size_t i = 0; i < bodies.size(); ++i) {
    const int body = chain_.body_of_link[static_cast<std::size_t>(bodies[i].link)];
    if (body == 0) continue;
    const auto [it, fresh] = part_of.try_emplace({body, bodies[i].what}, parts_.size());
    if (fresh) parts_.push_back({body, bodies[i].what, {}, 0});
    parts_[it->second].shapes.push_back(static_cast<int>(i));
  }
}

void BatchWorld::make_pairs(const std::vector<Body>& bodies,
                            const std::vector<std::pair<int, int>>& pairs) {
  std::vector<int> root_of(bodies.size(), -1);
  std::vector<int> part_of(bodies.size(), -1);
  const auto place = [&](std::size_t i) {
    return chain_.T_body_link[static_cast<std::size_t>(bodies[i].link)] * bodies[i].T_link_shape;
  };
  for (std::size_t p = 0; p < parts_.size(); ++p) {
    Part& part = parts_[p];
    std::vector<int> roots;
    for (int i : part.shapes) {
      root_of[static_cast<std::size_t>(i)] =
          add_tree(*bodies[static_cast<std::size_t>(i)].cover, place(static_cast<std::size_t>(i)),
                   part.body);
      part_of[static_cast<std::size_t>(i)] = static_cast<int>(p);
      roots.push_back(root_of[static_cast<std::size_t>(i)]);
    }
    part.root = add_root(roots, part.body);
  }
  std::map<std::pair<int, int>, std::vector<detail::SimdNodePair>> of_roots;
  std::map<std::pair<int, int>, std::vector<int>>
      against_solid;  // part, body -> shapes of the part
  for (auto [a, b] : pairs) {
    auto i = static_cast<std::size_t>(a), j = static_cast<std::size_t>(b);
    const int body_i = chain_.body_of_link[static_cast<std::size_t>(bodies[i].link)],
              body_j = chain_.body_of_link[static_cast<std::size_t>(bodies[j].link)];
    if (body_i == body_j) continue;
    if (body_i == 0) std::swap(i, j);
    if (body_i == 0 || body_j == 0) {
      if (primitive(bodies[j].shape)) {
        against_solid[{part_of[i], static_cast<int>(j)}].push_back(static_cast<int>(i));
        continue;
      }
      if (root_of[j] < 0) root_of[j] = add_tree(*bodies[j].cover, place(j), 0);
      of_roots[{parts_[static_cast<std::size_t>(part_of[i])].root, root_of[j]}].push_back(
          {root_of[i], root_of[j]});
      continue;
    }
    of_roots[{parts_[static_cast<std::size_t>(part_of[i])].root,
              parts_[static_cast<std::size_t>(part_of[j])].root}]
        .push_back({root_of[i], root_of[j]});
  }
  for (const auto& [roots, list] : of_roots) {
    pairs_.push_back({roots.first, roots.second, static_cast<std::int32_t>(node_pairs_.size()),
                      static_cast<std::int32_t>(list.size())});
    node_pairs_.insert(node_pairs_.end(), list.begin(), list.end());
  }
  for (const auto& [key, shapes] : against_solid) {
    const auto j = static_cast<std::size_t>(key.second);
    detail::SimdSearch search{parts_[static_cast<std::size_t>(key.first)].root,
                              static_cast<std::int32_t>(node_list_.size()),
                              static_cast<std::int32_t>(shapes.size()),
                              static_cast<std::int32_t>(solid_list_.size()),
                              1,
                              -1};
    for (int i : shapes) node_list_.push_back(root_of[static_cast<std::size_t>(i)]);
    if (!add_solid(bodies[j].shape, place(j))) continue;
    solid_list_.push_back(static_cast<std::int32_t>(solids_.size()) - 1);
    searches_.push_back(search);
  }
}

/// Computes upper bounds of the distance of sphere centres from the axes above them, over all
/// configurations.
void BatchWorld::find_reach() {
  const std::size_t n = chain_.joints.size();
  std::vector<double> across(n + 1, 0.0), norm(n + 1, 0.0), largest(n + 1, 0.0);
  for (const detail::SimdNode& node : nodes_) {
    const auto b = static_cast<std::size_t>(node.body);
    across[b] =
        std::max(across[b], std::hypot(static_cast<double>(node.x), static_cast<double>(node.y)));
    norm[b] = std::max(norm[b], Vector3(node.x, node.y, node.z).norm());
    largest[b] = std::max(largest[b], static_cast<double>(node.radius));
  }
  reach_.assign((n + 1) * n, 0.0f);
  total_reach_ = 0;
  for (std::size_t b = 1; b <= n; ++b) {
    double bound = norm[b];  // of the centres from the origin of the current frame
    reach_[b * n + b - 1] =
        static_cast<float>(1.0001 * (chain_.joints[b - 1].slides ? 1.0 : across[b]));
    for (std::size_t at = b; at > 0;) {
      const Vector3 t = chain_.T_parent_joint[at - 1].translation();
      const auto above = static_cast<std::size_t>(chain_.joints[at - 1].parent);
      const double below = bound + chain_.slide[at - 1];
      if (above > 0) {
        const double perpendicular = std::hypot(t.x(), t.y()) + below;
        reach_[b * n + above - 1] =
            static_cast<float>(1.0001 * (chain_.joints[above - 1].slides ? 1.0 : perpendicular));
      }
      bound = t.norm() + below;
      at = above;
    }
    total_reach_ = std::max(total_reach_, bound + largest[b]);
  }
  rounding_ = kRoundingRatio * std::max(1.0, total_reach_);
}

/// Adds a solid; returns false if it is outside the robot's reach.
bool BatchWorld::add_solid(const Shape& shape, const Pose& T_root_shape) {
  Vector3 half = Vector3::Zero();
  double radius = 0, cylinder = 0;
  if (const auto* box = std::get_if<Box>(&shape)) {
    half = 0.5 * box->size;
  } else if (const auto* sphere = std::get_if<Sphere>(&shape)) {
    radius = sphere->radius;
  } else if (const auto* capsule = std::get_if<Capsule>(&shape)) {
    half.z() = 0.5 * capsule->length;
    radius = capsule->radius;
  } else {
    const auto& round = std::get<Cylinder>(shape);
    half.z() = 0.5 * round.length;
    cylinder = round.radius;
  }
  // Only the part within reach of the root matters; large solids are clipped to it, so that their
  // coordinates do not exceed the robot's.
  const Vector3 root = T_root_shape.inverse().translation();
  const double reach = total_reach_ + radius + 0.01;
  Vector3 low, high;
  for (int i = 0; i < 3; ++i) {
    const bool round = cylinder > 0 && i < 2;
    low[i] = round ? 0.0 : std::max(-half[i], root[i] - reach);
    high[i] = round ? 0.0 : std::min(half[i], root[i] + reach);
    if (low[i] > high[i]) return false;
  }
  const Vector3 outside = Vector3((root - high).cwiseMax(low - root)).cwiseMax(0.0);
  if (cylinder > 0 ? std::hypot(root.x(), root.y()) - cylinder > reach : outside.norm() > reach)
    return false;
  const Pose T = T_root_shape * Eigen::Translation3d(0.5 * (low + high));
  const Eigen::Matrix3d axes = T.linear().transpose();
  const Vector3 at = axes * T.translation();
  detail::SimdSolid solid{};
  for (int i = 0; i < 3; ++i) {
    for (int k = 0; k < 3; ++k) solid.axes[3 * i + k] = static_cast<float>(axes(i, k));
    solid.at[i] = static_cast<float>(at[i]);
    solid.half[i] = static_cast<float>(0.5 * (high[i] - low[i]));
  }
  solid.cylinder = static_cast<float>(cylinder);
  solid.radius =
      static_cast<float>(radius + 1e-6 * (T.translation().norm() + half.norm() + cylinder));
  solids_.push_back(solid);
  return true;
}

void BatchWorld::set_robot(const std::vector<Body>& bodies,
                           const std::vector<std::pair<int, int>>& pairs,
                           const std::vector<int>& axes, const Vector& q) {
  solids_.clear();
  node_list_.clear();
  solid_list_.clear();
  searches_.clear();
  pairs_.clear();
  node_pairs_.clear();
  chain_.fold(robot_, axes, q);
  place_trees(bodies);
  // Solids are clipped to the robot's reach, which requires the trees: a first pass computes it.
  total_reach_ = std::numeric_limits<double>::max() / 4;
  make_pairs(bodies, pairs);
  find_reach();
  for (detail::SimdNode& node : nodes_) node.radius += static_cast<float>(rounding_);
  const std::size_t n = chain_.joints.size();
  pair_reach_.clear();
  for (const detail::SimdPair& pair : pairs_) {
    const float* a =
        reach_.data() + static_cast<std::size_t>(nodes_[static_cast<std::size_t>(pair.a)].body) * n;
    const float* b =
        reach_.data() + static_cast<std::size_t>(nodes_[static_cast<std::size_t>(pair.b)].body) * n;
    for (std::size_t j = 0; j < n; ++j)
      pair_reach_.push_back(a[j] > 0 && b[j] > 0 ? 0.0f : a[j] + b[j]);
  }
  solid_rows_.clear();
  own_nodes_ = nodes_.size();
  own_solids_ = solids_.size();
  own_searches_ = searches_.size();
  own_pairs_ = pairs_.size();
  own_node_list_ = node_list_.size();
  own_solid_list_ = solid_list_.size();
  own_node_pairs_ = node_pairs_.size();
  allocate();
}

void BatchWorld::set_solids(const std::vector<Solid>& solids, const Pose& T_world_base) {
  nodes_.resize(own_nodes_);
  solids_.resize(own_solids_);
  searches_.resize(own_searches_);
  pairs_.resize(own_pairs_);
  node_list_.resize(own_node_list_);
  solid_list_.resize(own_solid_list_);
  node_pairs_.resize(own_node_pairs_);
  pair_reach_.resize(own_pairs_ * chain_.joints.size());
  solid_rows_.clear();
  const Pose T_base_world = T_world_base.inverse();
  std::vector<std::uint8_t> against;
  const std::size_t first = solids_.size();
  for (const Solid& solid : solids) {
    const Pose T_root_shape = T_base_world * solid.T_world_shape;
    if (primitive(solid.shape)) {
      if (add_solid(solid.shape, T_root_shape)) against.push_back(solid.against);
      continue;
    }
    const CoverNode& ball = solid.cover->nodes[0];
    if ((T_root_shape * ball.center).norm() - ball.radius > total_reach_ + 0.01) continue;
    const int root = add_tree(*solid.cover, T_root_shape, 0);
    for (std::size_t i = static_cast<std::size_t>(root); i < nodes_.size(); ++i)
      nodes_[i].radius += static_cast<float>(rounding_);
    for (const Part& part : parts_) {
      if ((part.what & solid.against) == 0) continue;
      pairs_.push_back({part.root, root, static_cast<std::int32_t>(node_pairs_.size()), 1});
      node_pairs_.push_back({part.root, root});
      const float* reach =
          reach_.data() + static_cast<std::size_t>(part.body) * chain_.joints.size();
      pair_reach_.insert(pair_reach_.end(), reach, reach + chain_.joints.size());
    }
  }
  // Distal parts usually collide first.
  for (auto part = parts_.rbegin(); part != parts_.rend(); ++part) {
    detail::SimdSearch search{part->root, 0, 0, static_cast<std::int32_t>(solid_list_.size()),
                              0,          -1};
    for (std::size_t i = 0; i < against.size(); ++i)
      if ((against[i] & part->what) != 0)
        solid_list_.push_back(static_cast<std::int32_t>(first + i));
    search.solids = static_cast<std::int32_t>(solid_list_.size()) - search.first_solid;
    if (search.solids == 0) continue;
    if (search.solids >= kRowsFrom) put_in_rows(search);
    searches_.push_back(search);
  }
  allocate();
}

void BatchWorld::put_in_rows(detail::SimdSearch& search) {
  search.first_row = static_cast<std::int32_t>(solid_rows_.size());
  for (int k = 0; k < search.solids; ++k) {
    if (k % kStates == 0) {
      solid_rows_.emplace_back();
      std::fill(std::begin(solid_rows_.back().at[0]), std::end(solid_rows_.back().at[0]), 1e15f);
    }
    const detail::SimdSolid& solid = solids_[static_cast<std::size_t>(
        solid_list_[static_cast<std::size_t>(search.first_solid + k)])];
    detail::SimdSolids& row = solid_rows_.back();
    const int slot = k % kStates;
    for (int i = 0; i < 9; ++i) row.axes[i][slot] = solid.axes[i];
    for (int i = 0; i < 3; ++i) {
      row.at[i][slot] = solid.at[i];
      row.half[i][slot] = solid.cylinder > 0 && i < 2 ? solid.cylinder : solid.half[i];
    }
    row.radius[slot] = solid.radius;
  }
}

void BatchWorld::allocate() {
  const std::size_t bodies = chain_.joints.size() + 1;
  if (position_room_ < nodes_.size()) {
    position_room_ = nodes_.size() + nodes_.size() / 4;
    position_ = floats(3 * kStates * position_room_);
  }
  pose_ = floats(12 * kStates * bodies);
  margin_ = floats(kStates * bodies);
  q_ = floats(kStates * chain_.dof_of_row.size());
  half_ = floats(kStates * chain_.dof_of_row.size());
  stamp_.assign(nodes_.size(), 0);
  std::int32_t max_list_size = 1;
  for (const detail::SimdSearch& search : searches_)
    max_list_size = std::max(max_list_size, search.solids);
  lists_.assign(static_cast<std::size_t>(max_list_size) * detail::kMaxTreeDepth, 0);
  tables_.joints = chain_.joints.data();
  tables_.nodes = nodes_.data();
  tables_.solids = solids_.data();
  tables_.solid_rows = solid_rows_.data();
  tables_.node_list = node_list_.data();
  tables_.solid_list = solid_list_.data();
  tables_.searches = searches_.data();
  tables_.pairs = pairs_.data();
  tables_.node_pairs = node_pairs_.data();
  tables_.reach = reach_.data();
  tables_.pair_reach = pair_reach_.data();
  tables_.joint_count = static_cast<std::int32_t>(chain_.joints.size());
  tables_.node_count = static_cast<std::int32_t>(nodes_.size());
  tables_.search_count = static_cast<std::int32_t>(searches_.size());
  tables_.pair_count = static_cast<std::int32_t>(pairs_.size());
  memory_ = {pose_.get(), margin_.get(), position_.get(), stamp_.data(),
             0,           lists_.data(), max_list_size};
}

std::uint32_t BatchWorld::run(int count, bool swept, bool any) {
  if (memory_.now > 0xfffffff0u) {
    std::fill(stamp_.begin(), stamp_.end(), 0);
    memory_.now = 0;
  }
  ++blocks_;
  const std::uint32_t state_bits = count >= kStates ? 0xffffu : (1u << count) - 1u;
  return kernels_->check(tables_, memory_, q_.get(), swept ? half_.get() : nullptr, state_bits,
                         any);
}

std::uint32_t BatchWorld::unclear(const Vector* states, int count) {
  for (std::size_t row = 0; row < chain_.dof_of_row.size(); ++row)
    for (int i = 0; i < count; ++i) {
      const double value = states[i][chain_.dof_of_row[row]];
      if (!(std::abs(value) < kMaxTurn)) return (1u << count) - 1u;
      q_[row * kStates + static_cast<std::size_t>(i)] = static_cast<float>(value);
    }
  return run(count, false);
}

std::uint32_t BatchWorld::unclear_on_line(const Vector& from, const Vector& to, const double* at,
                                          int count, bool any) {
  for (std::size_t row = 0; row < chain_.dof_of_row.size(); ++row) {
    const double start = from[chain_.dof_of_row[row]], along = to[chain_.dof_of_row[row]] - start;
    if (!(std::abs(start) + std::abs(along) < kMaxTurn)) return (1u << count) - 1u;
    float* q = q_.get() + row * kStates;
    for (int i = 0; i < count; ++i) q[i] = static_cast<float>(start + at[i] * along);
  }
  return run(count, false, any);
}

std::uint32_t BatchWorld::unclear_boxes(const Vector* low, const Vector* high, int count) {
  for (std::size_t row = 0; row < chain_.dof_of_row.size(); ++row)
    for (int i = 0; i < count; ++i) {
      const double from = low[i][chain_.dof_of_row[row]], to = high[i][chain_.dof_of_row[row]];
      if (!(std::max(std::abs(from), std::abs(to)) < kMaxTurn)) return (1u << count) - 1u;
      q_[row * kStates + static_cast<std::size_t>(i)] = static_cast<float>(0.5 * (from + to));
      half_[row * kStates + static_cast<std::size_t>(i)] =
          static_cast<float>(0.5000001 * (to - from));
    }
  return run(count, true);
}

const std::vector<std::pair<double, double>>& BatchWorld::unclear_stretches(const Vector& from,
                                                                            const Vector& to,
                                                                            double finest,
                                                                            int max_blocks) {
  unclear_.clear();
  open_.clear();
  next_.clear();
  for (std::size_t row = 0; row < chain_.dof_of_row.size(); ++row)
    if (!(std::abs(from[chain_.dof_of_row[row]]) + std::abs(to[chain_.dof_of_row[row]]) <
          kMaxTurn)) {
      unclear_.emplace_back(0.0, 1.0);
      return unclear_;
    }
  for (int i = 0; i < kStates; ++i)
    open_.emplace_back(static_cast<double>(i) / kStates, (i + 1.0) / kStates);
  for (int blocks = 0; !open_.empty(); open_.swap(next_), next_.clear())
    for (std::size_t first = 0; first < open_.size(); first += kStates, ++blocks) {
      const int count = static_cast<int>(std::min<std::size_t>(kStates, open_.size() - first));
      std::uint32_t unclear = (1u << count) - 1u;
      if (blocks < max_blocks) {
        for (std::size_t row = 0; row < chain_.dof_of_row.size(); ++row) {
          const double start = from[chain_.dof_of_row[row]],
                       along = to[chain_.dof_of_row[row]] - start;
          for (int i = 0; i < count; ++i) {
            const auto [low, high] = open_[first + static_cast<std::size_t>(i)];
            q_[row * kStates + static_cast<std::size_t>(i)] =
                static_cast<float>(start + 0.5 * (low + high) * along);
            half_[row * kStates + static_cast<std::size_t>(i)] =
                static_cast<float>(0.5000001 * (high - low) * std::abs(along));
          }
        }
        unclear = run(count, true);
      }
      for (int i = 0; i < count; ++i) {
        if ((unclear >> i & 1) == 0) continue;
        const auto [low, high] = open_[first + static_cast<std::size_t>(i)];
        if (blocks >= max_blocks || 0.5 * (high - low) < finest)
          unclear_.emplace_back(low, high);
        else
          for (const auto& half :
               {std::pair{low, 0.5 * (low + high)}, std::pair{0.5 * (low + high), high}})
            next_.push_back(half);
      }
    }
  std::sort(unclear_.begin(), unclear_.end());
  return unclear_;
}

Pose BatchWorld::link_pose(int link, int slot) const {
  const int width = kernels_->width;
  const int body = chain_.body_of_link[static_cast<std::size_t>(link)];
  Pose T = Pose::Identity();
  for (int i = 0; i < 3; ++i)
    for (int k = 0; k < 4; ++k)
      T.matrix()(i, k) = pose_[static_cast<std::size_t>(body) * 12 * kStates +
                               static_cast<std::size_t>((4 * i + k) * width + slot % width)];
  return T * chain_.T_body_link[static_cast<std::size_t>(link)];
}

}  // namespace handsel
