# For ESP-IDF and Zephyr: sets edmlift_sources, which Kconfig chooses, and edmlift_flags.
#
# ESP-IDF includes this once in a script, without a configuration.
get_filename_component(edmlift_root ${CMAKE_CURRENT_LIST_DIR} DIRECTORY)
file(GLOB edmlift_sources ${edmlift_root}/lib/*/*.c)

# How the names of an optional part's files begin.
set(edmlift_optional_ANGLES angle)
set(edmlift_optional_BODY body|joint_limit|uncertainty)
set(edmlift_optional_CAMERA camera)
set(edmlift_optional_MANY many)
set(edmlift_optional_VIDEO video)
foreach(part ANGLES BODY CAMERA MANY VIDEO)
  if(NOT CONFIG_EDMLIFT_${part})
    list(FILTER edmlift_sources EXCLUDE REGEX "/lib/optional/(${edmlift_optional_${part}})[^/]*$")
  endif()
endforeach()

file(GLOB models RELATIVE ${edmlift_root}/lib/models ${edmlift_root}/lib/models/*.c)
foreach(model IN LISTS models)
  string(REPLACE ".c" "" name ${model})
  string(TOUPPER ${name} name)
  if(NOT CONFIG_EDMLIFT_${name})
    list(REMOVE_ITEM edmlift_sources ${edmlift_root}/lib/models/${model})
  endif()
endforeach()

set(edmlift_flags -ffp-contract=off -fno-math-errno) # EdmliftFlags.cmake says why
