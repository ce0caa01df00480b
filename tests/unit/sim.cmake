handsel_test(sim SOURCES ${CMAKE_CURRENT_LIST_DIR}/sim_test.cpp LINK handsel_sim_core LABEL unit)
handsel_test(sim_oracle SOURCES ${CMAKE_CURRENT_LIST_DIR}/sim_oracle_test.cpp LINK handsel_sim_core LABEL unit)
handsel_test(sim_person SOURCES ${CMAKE_CURRENT_LIST_DIR}/sim_person_test.cpp LINK handsel_sim_core LABEL unit)
