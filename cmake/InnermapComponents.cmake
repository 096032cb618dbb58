# Parts that a build may leave out: the room of that name in lib/, and the folders of that name in other
# rooms, in the program, in the Python module and among the tests. Nothing outside them includes what is in
# them (tests/layering.py) but the lists of commands, of the module's functions and of a report's sections.
option(INNERMAP_TETRA "Build meshes of tetrahedra and hexahedra, and finite elements on them" ON)
option(INNERMAP_STUDY "Build studies of a map's error by its settings" ON)

set(INNERMAP_LEFT_OUT "")
foreach(component tetra study)
  string(TOUPPER ${component} option)
  if(NOT INNERMAP_${option})
    list(APPEND INNERMAP_LEFT_OUT ${component})
  endif()
endforeach()

# innermap_leave_out(VARIABLE): takes the files of parts that are left out from its list.
function(innermap_leave_out files_of)
  set(kept "")
  foreach(source IN LISTS ${files_of})
    file(RELATIVE_PATH path ${PROJECT_SOURCE_DIR} ${source})
    set(keep ON)
    foreach(component IN LISTS INNERMAP_LEFT_OUT)
      if(path MATCHES "/${component}/")
        set(keep OFF)
      endif()
    endforeach()
    if(keep)
      list(APPEND kept ${source})
    endif()
  endforeach()
  set(${files_of} ${kept} PARENT_SCOPE)
endfunction()

# innermap_tell_components(FILE): defines INNERMAP_TETRA and INNERMAP_STUDY, 1 or 0, for a list of what
# there is.
function(innermap_tell_components file)
  set_source_files_properties(${file} PROPERTIES COMPILE_DEFINITIONS
    "INNERMAP_TETRA=$<BOOL:${INNERMAP_TETRA}>;INNERMAP_STUDY=$<BOOL:${INNERMAP_STUDY}>")
endfunction()
