# SPDX-License-Identifier: Apache-2.0
# The structure of the tree: its figures against their limits, and what measures them. Any Python from
# 3.9 on runs them; without one they are not there, without Universal Ctags they are skipped.
find_package(Python3 3.9 COMPONENTS Interpreter)
if(Python3_Interpreter_FOUND)
  add_test(NAME structure COMMAND ${Python3_EXECUTABLE} ${CMAKE_CURRENT_LIST_DIR}/measure.py)
  add_test(NAME structure_measure COMMAND ${Python3_EXECUTABLE} ${CMAKE_CURRENT_LIST_DIR}/measure_test.py)
  set_tests_properties(structure structure_measure PROPERTIES LABELS structure SKIP_RETURN_CODE 77 TIMEOUT 120)
else()
  message(STATUS "Python 3.9 or newer is missing: no tests structure, structure_measure")
endif()
