# SPDX-License-Identifier: Apache-2.0
# What others link: the libraries from projects outside the tree, and the Python package.
set(outside ${CMAKE_CURRENT_LIST_DIR}/outside_test.sh)
foreach(kind installed models shared fetched)
  add_test(NAME libraries_${kind} COMMAND ${outside} ${kind} ${handsel_SOURCE_DIR} ${handsel_BINARY_DIR} ${CMAKE_COMMAND})
endforeach()
set_tests_properties(libraries_installed libraries_models PROPERTIES LABELS system TIMEOUT 600)
set_tests_properties(libraries_shared libraries_fetched PROPERTIES LABELS full TIMEOUT 1800)

# handsel_python_test(<name> <file> <label> [argument...]): runs python/<file>_test.py.
function(handsel_python_test name file label)
  add_test(NAME python_${name} COMMAND ${HANDSEL_PYTHON_EXECUTABLE} -B ${handsel_SOURCE_DIR}/tests/libraries/python/${file}_test.py ${ARGN})
  set(timeout 600)
  if(label STREQUAL full)
    set(timeout 3600)
  endif()
  set_tests_properties(python_${name} PROPERTIES LABELS ${label} TIMEOUT ${timeout}
    ENVIRONMENT "PYTHONPATH=${handsel_BINARY_DIR}/python;HANDSEL_SOURCE_DIR=${handsel_SOURCE_DIR}")
endfunction()
foreach(part trajectory grasp recording model collision arguments documentation examples)
  handsel_python_test(${part} ${part} unit)
endforeach()
handsel_python_test(environment environment system)
handsel_python_test(notebooks notebooks system)
