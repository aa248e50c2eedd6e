# What ESP-IDF does first with a component's CMakeLists.txt: a script reads it up to the registration.
macro(idf_component_register)
  set(registered ON)
  return()
endmacro()

function(read_component)
  include(${FOLDER}/CMakeLists.txt)
  if(NOT registered)
    message(FATAL_ERROR "${FOLDER}/CMakeLists.txt registers no component")
  endif()
endfunction()
get_filename_component(FOLDER ${FOLDER} ABSOLUTE)
read_component()
