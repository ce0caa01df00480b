# SPDX-License-Identifier: Apache-2.0
# Each row runs the command; HANDSEL_BIN names another folder of binaries, e.g. that of the preset asan.
set(bad_files_folder ${CMAKE_CURRENT_LIST_DIR}/bad_files)
handsel_test(bad_files GROUP live
  SOURCES ${bad_files_folder}/bad_files_test.cpp ${bad_files_folder}/bad_files_models.cpp ${bad_files_folder}/bad_files_settings.cpp ${bad_files_folder}/bad_files_scenarios.cpp
          ${bad_files_folder}/bad_files_recordings.cpp ${bad_files_folder}/bad_files_lines.cpp
  LINK handsel_options LABEL system)
target_compile_definitions(tests_live PRIVATE HANDSEL_COMMAND="$<TARGET_FILE:handsel>")
add_dependencies(tests_live product handsel_position_arm handsel_reflex_arm)
set_tests_properties(bad_files PROPERTIES PROCESSORS 2 TIMEOUT 600)
