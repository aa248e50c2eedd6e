# Stands for ESP-IDF: builds a project of the components main and edmlift with the toolchain file that is given.
#
# SDKCONFIG is a file that Kconfig wrote, MAIN_TASK_STACK the bytes that app_main() has.
include(${CMAKE_CURRENT_LIST_DIR}/../../../board.cmake)
set(IDF_STUB ${CMAKE_CURRENT_LIST_DIR}/../..)

# The flags that ESP-IDF 6 gives all components where a project says nothing.
set(IDF_FLAGS -std=gnu17 -Og -ffunction-sections -fdata-sections -fno-jump-tables -fno-tree-switch-conversion
    -fstrict-volatile-bitfields -Wall -Wextra -Werror -Wno-unused-parameter -Wno-sign-compare
    -Wno-enum-conversion -Wno-old-style-declaration -fstack-usage)

function(idf_component_register)
  cmake_parse_arguments(component "" "" "SRCS;INCLUDE_DIRS;REQUIRES" ${ARGN})
  get_filename_component(name ${CMAKE_CURRENT_SOURCE_DIR} NAME)
  set(COMPONENT_LIB __idf_${name} PARENT_SCOPE)
  add_library(__idf_${name} STATIC ${component_SRCS})
  target_compile_options(__idf_${name} PRIVATE ${IDF_FLAGS})
  target_include_directories(__idf_${name} PUBLIC ${component_INCLUDE_DIRS} PRIVATE ${IDF_STUB}/include)
  list(REMOVE_ITEM component_REQUIRES esp_timer) # of ESP-IDF's own: board.c has it
  list(TRANSFORM component_REQUIRES PREPEND __idf_)
  target_link_libraries(__idf_${name} PUBLIC ${component_REQUIRES})
endfunction()

macro(project name)
  _project(${name} C)
  set(ESP_PLATFORM 1)
  read_configuration(${SDKCONFIG})
  file(STRINGS main/idf_component.yml override REGEX "override_path")
  string(REGEX REPLACE "^ *override_path: *([^ ]+).*" "main/\\1" override "${override}")
  get_filename_component(component ${override} ABSOLUTE)
  foreach(folder main ${component})
    # ESP-IDF asks for requirements first, by a script that has no configuration.
    execute_process(COMMAND ${CMAKE_COMMAND} -DESP_PLATFORM=1 -DFOLDER=${folder}
                            -P ${IDF_STUB}/tools/cmake/requirements.cmake
                    WORKING_DIRECTORY ${CMAKE_CURRENT_SOURCE_DIR} RESULT_VARIABLE failed)
    if(failed)
      message(FATAL_ERROR "The requirements of ${folder} cannot be read")
    endif()
  endforeach()
  add_subdirectory(${component} esp-idf/edmlift)
  add_subdirectory(main esp-idf/main)
  add_board_program(app ${IDF_STUB}/board.c ${MAIN_TASK_STACK} __idf_main)
  target_include_directories(app PRIVATE ${IDF_STUB}/include)
  add_bits(__idf_edmlift)
endmacro()
