# SPDX-License-Identifier: Apache-2.0
# What others link: the libraries from projects outside the tree, and the Python package.
set(outside ${CMAKE_CURRENT_LIST_DIR}/outside_test.sh)
foreach(kind installed models shared fetched)
  add_test(NAME libraries_${kind} COMMAND ${outside} ${kind} ${handsel_SOURCE_DIR} ${handsel_BINARY_DIR} ${CMAKE_COMMAND})
endforeach()
set_tests_properties(libraries_installed libraries_models PROPERTIES LABELS system TIMEOUT 600)
set_tests_properties(libraries_shared libraries_fetched PROPERTIES LABELS full TIMEOUT 1800)

foreach(part trajectory grasp recording model collision arguments documentation examples)
  add_test(NAME python_${part} COMMAND ${HANDSEL_PYTHON_EXECUTABLE} -B ${CMAKE_CURRENT_LIST_DIR}/python/${part}_test.py)
  set_tests_properties(python_${part} PROPERTIES LABELS unit TIMEOUT 120
    ENVIRONMENT "PYTHONPATH=${handsel_BINARY_DIR}/python;HANDSEL_SOURCE_DIR=${handsel_SOURCE_DIR}")
endforeach()
