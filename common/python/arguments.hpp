// SPDX-License-Identifier: Apache-2.0
// Arguments from Python as numbers and arrays. Every function throws a Python exception with one
// sentence that names the argument: TypeError for a wrong type, ValueError for a wrong size or a
// number that is not finite.
#pragma once

#include <pybind11/numpy.h>
#include <pybind11/pybind11.h>

#include <cmath>
#include <filesystem>
#include <string>
#include <vector>

#include <Eigen/Core>

#include "common/python/unlocked.hpp"

namespace handsel::python {

namespace py = pybind11;
using RowMatrix = Eigen::Matrix<double, Eigen::Dynamic, Eigen::Dynamic, Eigen::RowMajor>;

/// Returns the name of the type of an object, for sentences.
inline std::string type_name(py::handle value) { return Py_TYPE(value.ptr())->tp_name; }

/// Returns an array of doubles in C order with the values of `value`: an array of float or int of
/// any layout, or a sequence of numbers. Infinite values and NaN pass.
inline py::array_t<double, py::array::c_style> number_array(py::handle value, const char* name) {
  if (!py::isinstance<py::array>(value)) {
    if (value.is_none() || py::isinstance<py::str>(value) || PyDict_Check(value.ptr()))
      throw py::type_error(std::string(name) + " must be an array of numbers, not " +
                           type_name(value) + ".");
  }
  py::array array = py::array::ensure(value);
  if (!array) {
    PyErr_Clear();
    throw py::value_error(std::string(name) +
                          " must be an array of numbers with rows of equal length.");
  }
  const char kind = array.dtype().kind();
  if (kind != 'f' && kind != 'i' && kind != 'u')
    throw py::type_error(std::string(name) + " must be an array of float or int, not of " +
                         py::str(array.dtype()).cast<std::string>() + ".");
  auto numbers = py::array_t<double, py::array::c_style | py::array::forcecast>::ensure(array);
  if (!numbers) {
    PyErr_Clear();
    throw py::value_error(std::string(name) + " cannot be read as an array of float.");
  }
  return py::reinterpret_borrow<py::array_t<double, py::array::c_style>>(numbers);
}

/// Throws ValueError when one of `count` numbers is NaN or infinite.
inline void require_finite(const double* values, py::ssize_t count, const char* name) {
  for (py::ssize_t i = 0; i < count; ++i) {
    if (!std::isfinite(values[i]))
      throw py::value_error(std::string(name) + " must be finite; element " + std::to_string(i) +
                            " is " + (std::isnan(values[i]) ? "NaN" : "infinite") + ".");
  }
}

/// Throws ValueError unless `size` is `expected`; a negative `expected` allows any size.
inline void require_size(py::ssize_t size, py::ssize_t expected, const char* name) {
  if (expected >= 0 && size != expected)
    throw py::value_error(std::string(name) + " must have " + std::to_string(expected) +
                          " elements, not " + std::to_string(size) + ".");
}

/// Returns whether `value` is a one-dimensional array of aligned doubles in the machine's byte
/// order, which can be read in place.
inline bool is_plain_vector(py::handle value) {
  if (!py::detail::npy_api::get().PyArray_Check_(value.ptr())) return false;
  const auto* array = py::detail::array_proxy(value.ptr());
  const auto* type = py::detail::array_descriptor_proxy(array->descr);
  return array->nd == 1 && type->type_num == py::detail::npy_api::NPY_DOUBLE_ &&
         type->byteorder == '=' &&
         py::detail::check_flags(value.ptr(), py::detail::npy_api::NPY_ARRAY_ALIGNED_);
}

/// Returns a vector of finite numbers; `size`: expected number of elements, negative: any.
inline Eigen::VectorXd vector(py::handle value, const char* name, py::ssize_t size = -1) {
  if (is_plain_vector(value)) {
    const auto* array = py::detail::array_proxy(value.ptr());
    require_size(array->dimensions[0], size, name);
    Eigen::VectorXd out(array->dimensions[0]);
    for (py::ssize_t i = 0; i < out.size(); ++i)
      out[i] = *reinterpret_cast<const double*>(array->data + i * array->strides[0]);
    require_finite(out.data(), out.size(), name);
    return out;
  }
  const auto array = number_array(value, name);
  if (array.ndim() != 1)
    throw py::value_error(std::string(name) + " must have one dimension, not " +
                          std::to_string(array.ndim()) + ".");
  require_size(array.shape(0), size, name);
  require_finite(array.data(), array.shape(0), name);
  return Eigen::Map<const Eigen::VectorXd>(array.data(), array.shape(0));
}

/// Returns rows of finite numbers; `columns`: expected number of columns, negative: any.
inline RowMatrix rows(py::handle value, const char* name, py::ssize_t columns = -1) {
  const auto array = number_array(value, name);
  if (array.ndim() != 2)
    throw py::value_error(std::string(name) + " must have two dimensions, not " +
                          std::to_string(array.ndim()) + ".");
  if (columns >= 0 && array.shape(1) != columns)
    throw py::value_error(std::string(name) + " must have " + std::to_string(columns) +
                          " columns, not " + std::to_string(array.shape(1)) + ".");
  require_finite(array.data(), array.size(), name);
  return Eigen::Map<const RowMatrix>(array.data(), array.shape(0), array.shape(1));
}

/// Returns a finite number; bool and text are refused.
inline double number(py::handle value, const char* name) {
  if (PyBool_Check(value.ptr()) || (!PyFloat_Check(value.ptr()) && !PyNumber_Check(value.ptr())))
    throw py::type_error(std::string(name) + " must be a number, not " + type_name(value) + ".");
  const double out = PyFloat_AsDouble(value.ptr());
  if (out == -1.0 && PyErr_Occurred() != nullptr) {
    const bool too_large = PyErr_ExceptionMatches(PyExc_OverflowError) != 0;
    PyErr_Clear();
    if (too_large) throw py::value_error(std::string(name) + " is too large.");
    throw py::type_error(std::string(name) + " must be a number, not " + type_name(value) + ".");
  }
  require_finite(&out, 1, name);
  return out;
}

/// Returns a whole number in [min, max]; bool and float are refused.
inline long long whole(py::handle value, const char* name, long long min, long long max) {
  if (PyBool_Check(value.ptr()) || PyIndex_Check(value.ptr()) == 0)
    throw py::type_error(std::string(name) + " must be an int, not " + type_name(value) + ".");
  const py::object index = py::reinterpret_steal<py::object>(PyNumber_Index(value.ptr()));
  if (!index) throw py::error_already_set();
  int overflow = 0;
  const long long out = PyLong_AsLongLongAndOverflow(index.ptr(), &overflow);
  if (overflow != 0 || out < min || out > max)
    throw py::value_error(std::string(name) + " must be in " + std::to_string(min) + " .. " +
                          std::to_string(max) + ".");
  return out;
}

/// Returns a text; anything else than str is refused.
inline std::string text(py::handle value, const char* name) {
  if (!py::isinstance<py::str>(value))
    throw py::type_error(std::string(name) + " must be a str, not " + type_name(value) + ".");
  Py_ssize_t size = 0;
  const char* utf8 = PyUnicode_AsUTF8AndSize(value.ptr(), &size);
  if (utf8 == nullptr) {
    PyErr_Clear();
    throw py::value_error(std::string(name) + " must be valid Unicode without lone surrogates.");
  }
  return {utf8, static_cast<std::size_t>(size)};
}

/// Returns an array of `count` doubles, copied.
inline py::array_t<double> to_array(const double* values, py::ssize_t count) {
  return py::array_t<double>(count, values);
}
/// Returns an array with the elements of a vector, copied.
inline py::array_t<double> to_array(const Eigen::VectorXd& values) {
  return to_array(values.data(), values.size());
}
/// Returns a two-dimensional array with the elements of a matrix, copied.
inline py::array_t<double> to_array(const RowMatrix& values) {
  py::array_t<double> out({values.rows(), values.cols()});
  std::copy(values.data(), values.data() + values.size(), out.mutable_data());
  return out;
}

}  // namespace handsel::python
