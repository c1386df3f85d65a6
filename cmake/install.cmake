# What `cmake --install` puts into place: the program, its part in Python, decks, pages with their links, manual page, completion.
install(PROGRAMS $<TARGET_FILE:splitgrain> DESTINATION ${CMAKE_INSTALL_BINDIR})
install(DIRECTORY input_decks DESTINATION ${CMAKE_INSTALL_DATADIR}/splitgrain)
# A wheel has the Python packages by itself, and no links.
if(SKBUILD)
  return()
endif()
install(DIRECTORY postpro/splitgrain_postpro postpro/splitgrain DESTINATION ${CMAKE_INSTALL_DATADIR}/splitgrain/postpro
        FILES_MATCHING PATTERN "*.py" PATTERN "*.html" PATTERN "vendor/*" PATTERN "__pycache__" EXCLUDE)
# Pages lead to decks and sources by the folders of the project: decks lie beside them, by a link.
install(FILES README.md LICENSE DESTINATION ${CMAKE_INSTALL_DOCDIR})
install(DIRECTORY doc DESTINATION ${CMAKE_INSTALL_DOCDIR} PATTERN site EXCLUDE)
file(RELATIVE_PATH decks_from_docs ${CMAKE_INSTALL_FULL_DOCDIR} ${CMAKE_INSTALL_FULL_DATADIR}/splitgrain/input_decks)
install(CODE "set(splitgrain_root \"\$ENV{DESTDIR}\${CMAKE_INSTALL_PREFIX}\")
  file(CREATE_LINK \"${decks_from_docs}\" \"\${splitgrain_root}/${CMAKE_INSTALL_DOCDIR}/input_decks\" SYMBOLIC)
  foreach(text manual completion)
    set(manual_file share/man/man1/splitgrain.1)
    set(completion_file share/bash-completion/completions/splitgrain)
    get_filename_component(folder \"\${splitgrain_root}/\${\${text}_file}\" DIRECTORY)
    file(MAKE_DIRECTORY \"\${folder}\")
    execute_process(COMMAND \"$<TARGET_FILE:splitgrain>\" reference --\${text} COMMAND_ERROR_IS_FATAL ANY
                    OUTPUT_FILE \"\${splitgrain_root}/\${\${text}_file}\")
  endforeach()")
