// SPDX-License-Identifier: Apache-2.0
// What handsel/collision.py calls.
#include "common/collision/collision_world.hpp"

#include <mutex>

#include "common/python/people_arguments.hpp"

namespace handsel::python {
namespace {

/// A world that several Python threads may use: one at a time.
class World {
 public:
  explicit World(const RobotModel& robot)
      : robot_(robot), world_(robot, [](const std::string&) { return nullptr; }) {}

  /// Calls `work` with the world, without the interpreter lock; it must not touch Python objects.
  template <class Work>
  void use(Work&& work) {
    const Unlocked released;
    const std::lock_guard<std::mutex> alone(mutex_);
    work(world_);
  }
  const RobotModel& robot() const { return robot_; }

 private:
  const RobotModel& robot_;
  std::mutex mutex_;
  CollisionWorld world_;
};

MeshPtr mesh_of(py::handle vertices, py::handle triangles) {
  const RowMatrix p = rows(vertices, "vertices", 3), t = rows(triangles, "triangles", 3);
  if (p.rows() < 3 || t.rows() < 1)
    throw py::value_error("a mesh must have at least 3 vertices and 1 triangle.");
  TriangleMesh mesh;
  for (Eigen::Index i = 0; i < p.rows(); ++i) mesh.vertices.push_back(p.row(i).transpose());
  for (Eigen::Index i = 0; i < t.rows(); ++i) {
    std::array<int, 3> corners{};
    for (int k = 0; k < 3; ++k) {
      const double index = t(i, k);
      if (!(index >= 0 && index < static_cast<double>(p.rows()) && index == std::floor(index)))
        throw py::value_error("triangles must hold indices of vertices, 0 .. " +
                              std::to_string(p.rows() - 1) + "; row " + std::to_string(i) +
                              " does not.");
      corners[static_cast<std::size_t>(k)] = static_cast<int>(index);
    }
    const Vector3 &a = mesh.vertices[static_cast<std::size_t>(corners[0])],
                  &b = mesh.vertices[static_cast<std::size_t>(corners[1])],
                  &c = mesh.vertices[static_cast<std::size_t>(corners[2])];
    if ((b - a).cross(c - a).norm() > 0) mesh.triangles.push_back(corners);
  }
  if (mesh.triangles.empty()) throw py::value_error("all triangles of a mesh have no area.");
  return std::make_shared<const TriangleMesh>(std::move(mesh));
}

/// Returns the shape of (kind, numbers) or ("mesh", vertices, triangles) or ("file", path).
Shape shape_of(const py::tuple& value) {
  const std::string kind = text(value[0], "kind");
  if (kind == "mesh") return mesh_of(value[1], value[2]);
  if (kind == "file")
    return std::make_shared<const TriangleMesh>(load_mesh(text(value[1], "file")));
  const Eigen::VectorXd size = vector(value[1], "size");
  if (!(size.minCoeff() > 0)) throw py::value_error("the size of a " + kind + " must be positive.");
  if (kind == "sphere") return Sphere{size[0]};
  if (kind == "box") return Box{Vector3(size)};
  if (kind == "cylinder") return Cylinder{size[0], size[1]};
  return Capsule{size[0], size[1]};
}

/// Returns obstacles from tuples (name, shape, pose).
std::vector<Obstacle> obstacles_of(const py::list& values) {
  std::vector<Obstacle> out;
  for (py::handle value : values) {
    const auto item = py::reinterpret_borrow<py::tuple>(value);
    out.push_back({text(item[0], "name"),
                   {shape_of(py::reinterpret_borrow<py::tuple>(item[1])), pose_of(item[2])}});
  }
  return out;
}

/// Returns configurations as rows, and whether there was one only.
std::pair<RowMatrix, bool> configurations(const World& world, py::handle q) {
  const auto array = number_array(q, "q");
  if (array.ndim() == 1)
    return {RowMatrix(vector(array, "q", world.robot().dof()).transpose()), true};
  return {rows(array, "q", world.robot().dof()), false};
}

py::tuple named(const CollisionVerdict& verdict) {
  return py::make_tuple(verdict.free, verdict.first, verdict.second);
}

/// Returns whether each configuration is free, a bool an entry.
py::array_t<bool> are_free(World& world, py::handle q) {
  const auto [values, one] = configurations(world, q);
  std::vector<char> free(static_cast<std::size_t>(values.rows()));
  const RowMatrix& all = values;
  world.use([&](CollisionWorld& w) {
    for (Eigen::Index i = 0; i < all.rows(); ++i)
      free[static_cast<std::size_t>(i)] = w.is_free(all.row(i).transpose()) ? 1 : 0;
  });
  py::array_t<bool> out(static_cast<py::ssize_t>(free.size()));
  std::copy(free.begin(), free.end(), out.mutable_data());
  return out;
}

/// Returns distances and the nearest points on robot and other, rows of 7 numbers.
template <class Distance>
py::array_t<double> distances(World& world, py::handle q, Distance&& distance) {
  const auto [values, one] = configurations(world, q);
  const RowMatrix& all = values;
  RowMatrix out = RowMatrix::Constant(all.rows(), 7, std::numeric_limits<double>::quiet_NaN());
  world.use([&](CollisionWorld& w) {
    for (Eigen::Index i = 0; i < all.rows(); ++i) {
      Vector3 on_robot = out.block<1, 3>(i, 1).transpose(), on_other = on_robot;
      out(i, 0) = distance(w, Vector(all.row(i).transpose()), &on_robot, &on_other);
      out.block<1, 3>(i, 1) = on_robot.transpose();
      out.block<1, 3>(i, 4) = on_other.transpose();
    }
  });
  return to_array(out);
}

py::tuple check_motion(World& world, py::handle from, py::handle to, py::handle step) {
  const int dof = world.robot().dof();
  const Vector a = vector(from, "start", dof), b = vector(to, "end", dof);
  const double each = number(step, "step");
  if (!(each >= 1e-4)) throw py::value_error("step must be at least 0.0001 rad.");
  CollisionVerdict verdict;
  world.use([&](CollisionWorld& w) { verdict = w.check_motion(a, b, each); });
  return named(verdict);
}

}  // namespace

void add_collision(py::module_& m) {
  py::class_<World>(m, "World")
      .def(py::init<const RobotModel&>(), py::keep_alive<1, 2>())
      .def("set_base",
           [](World& world, py::handle pose) {
             const Pose T = pose_of(pose, "base");
             world.use([&](CollisionWorld& w) { w.set_base(T); });
           })
      .def("set_obstacles",
           [](World& world, const py::list& values) {
             const std::vector<Obstacle> obstacles = obstacles_of(values);
             world.use([&](CollisionWorld& w) { w.set_obstacles(obstacles); });
           })
      .def("set_people",
           [](World& world, const py::list& values) {
             const HumanState people = people_of(values);
             world.use([&](CollisionWorld& w) { w.set_people(people); });
           })
      .def("check",
           [](World& world, py::handle q) {
             const Vector at = vector(q, "q", world.robot().dof());
             CollisionVerdict verdict;
             world.use([&](CollisionWorld& w) { verdict = w.check(at); });
             return named(verdict);
           })
      .def("are_free", &are_free)
      .def("check_motion", &check_motion)
      .def("to_people",
           [](World& world, py::handle q) {
             return distances(world, q,
                              [](CollisionWorld& w, const Vector& at, Vector3* a, Vector3* b) {
                                return w.distance_to_people(at, a, b);
                              });
           })
      .def("to_obstacles", [](World& world, py::handle q) {
        return distances(world, q, [](CollisionWorld& w, const Vector& at, Vector3* a, Vector3* b) {
          return w.distance_to_scene(at, std::numeric_limits<double>::infinity(), a, b);
        });
      });
  m.def("shape_distance",
        [](const py::tuple& a, py::handle at_a, const py::tuple& b, py::handle at_b) {
          const Shape first = shape_of(a), second = shape_of(b);
          const ShapeDistance out = shape_distance(first, pose_of(at_a), second, pose_of(at_b));
          return py::make_tuple(out.collide, out.distance);
        });
}

}  // namespace handsel::python
