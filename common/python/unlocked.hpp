// SPDX-License-Identifier: Apache-2.0
// Work without the interpreter lock.
#pragma once

#include <Python.h>
#include <cxxabi.h>
#include <unistd.h>

namespace handsel::python {

/// Releases the interpreter lock while it exists. When the interpreter ends meanwhile, the thread
/// sleeps until the process ends: Python 3.11 would unwind it through code that must not be
/// unwound.
class Unlocked {
 public:
  Unlocked() : state_(PyEval_SaveThread()) {}
  ~Unlocked() {
    try {
      PyEval_RestoreThread(state_);
    } catch (abi::__forced_unwind&) {
      for (;;) pause();
    }
  }
  Unlocked(const Unlocked&) = delete;
  Unlocked& operator=(const Unlocked&) = delete;

 private:
  PyThreadState* state_;
};

}  // namespace handsel::python
