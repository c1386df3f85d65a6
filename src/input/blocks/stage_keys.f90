!> Keys of a deck that a stage may change: sections that may stand within `[[stage]]`, and their keys.
module sg_stage_keys
  use sg_text, only: nearest_word, text_t
  implicit none
  private
  public :: may_stand_in_stage, section_for_stage

  !> Sections, and the keys of them that may change; without keys all
  character(len=136), parameter :: allowed(13) = [character(len=136) :: &
    'time: step theta substeps recovery recovery_every', 'solver:', 'partition:', 'output:', 'restart:', 'guard:', &
    'scene: gravity', 'cell: strain_rate_xx strain_rate_yy strain_rate_zz shear_rate stress_xx stress_yy stress_zz '// &
    'shear_stress inertia', 'law:', 'container: name stress_xx stress_yy stress_zz', 'drive:', 'pressure:', &
    'gravity:']
  !> Keys of allowed sections that may not change, though most others may
  character(len=16), parameter :: refused(1) = [character(len=16) :: 'partition.parts']

contains

  !> May a section stand within a stage? Then the text is empty, else the sentence that refuses it.
  pure function section_for_stage(name) result(message)
    character(len=*), intent(in) :: name !! name of the section
    character(len=:), allocatable :: message
    type(text_t) :: known(size(allowed))
    character(len=:), allocatable :: near
    character(len=len(allowed)) :: line
    integer :: i

    message = ''
    if (place_of(name) > 0) return
    do i = 1, size(allowed)
      line = allowed(i)
      known(i)%s = line(:index(line, ':') - 1)
    end do
    near = nearest_word(name, known)
    message = '"'//name//'" cannot change between stages'
    if (near /= '') message = 'unknown key "'//name//'" in [[stage]]; did you mean "'//near//'"?'
  end function section_for_stage

  !> May a key of a section change between stages?
  pure logical function may_stand_in_stage(section, key)
    character(len=*), intent(in) :: section !! name of the section
    character(len=*), intent(in) :: key !! name of the key
    integer :: i

    may_stand_in_stage = .false.
    i = place_of(section)
    if (i == 0 .or. any(refused == section//'.'//key)) return
    may_stand_in_stage = index(allowed(i), ':') == len_trim(allowed(i)) .or. index(allowed(i)//' ', ' '//key//' ') > 0
  end function may_stand_in_stage

  !> Line of the list with a section, or with the one around it; 0 where there is none.
  pure integer function place_of(section) result(place)
    character(len=*), intent(in) :: section
    character(len=:), allocatable :: outer

    outer = section(:index(section//'.', '.') - 1)
    do place = 1, size(allowed)
      if (index(allowed(place), outer//':') == 1) return
    end do
    place = 0
  end function place_of
end module sg_stage_keys
