!> Reads the POSTPRO.DAT of a DATBOX: where the record, tracks and pictures of a run hold what its commands ask for
!! (doc/guide/datbox.md), bodies to track, pairs of bodies to sum, and steps between two rows or pictures.
!!
!! A command stands in columns 1 to 30, before a line `STEP n`; its data follow.
module sg_datbox_postpro
  use sg_datbox_lines, only: columns, datbox_file_t, go_to, next_line, open_datbox_file
  use sg_datbox_settings, only: datbox_settings_t
  use sg_error, only: diagnostics_t
  use sg_numerals, only: read_integer
  use sg_text, only: append_word, joined, text_t, to_text
  implicit none
  private
  public :: read_postpro, warn_of_postpro

  !> Columns of a command, and most bodies of sets that are tracked
  integer, parameter :: width = 30, most_tracked = 1000
  !> Counterparts of commands: record.csv, [[track]], [[interface]], pictures, nothing
  character(len=9), parameter, public :: postpro_counterparts(5) = [character(len=9) :: 'record', 'track', 'interface', &
    'pictures', 'nothing']
  character(len=*), parameter :: in_record(18) = [character(len=width) :: 'SOLVER INFORMATIONS', 'AVERAGE VELOCITY EVOLUTION', &
    'SPECIES KINETIC ENERGY', 'KINETIC ENERGY', 'COORDINATION NUMBER', 'DENSE SAMPLE COMPACITY', 'COMPACITY EVOLUTION', &
    'TRIAXIAL COMPACITY', 'QUASI SLIDING CONTACT', 'DISSIPATED ENERGY', 'DRY CONTACT NATURE', 'VIOLATION EVOLUTION', &
    'PLPLx ANALYSIS', 'DISPLAY TENSORS', 'CZM ENERGY EVOLUTION', 'PRxxx DETECTION', 'NORMAL CONTACT DISTRIBUTION', &
    'WET CONTACT NATURE']
  character(len=*), parameter :: in_tracks(4) = [character(len=width) :: 'BODY TRACKING', 'TORQUE EVOLUTION', 'NEW RIGID SETS', &
    'NEW BOUNDED SETS']
  character(len=*), parameter :: one_pair = 'DOUBLET INTERACTIONS', list_of_pairs = 'DOUBLETS TORQUE EVOLUTION'
  character(len=*), parameter :: in_pictures(6) = [character(len=width) :: 'SNAPSHOT SAMPLE', 'MP SNAPSHOT SAMPLE', &
    'CONTACT FORCE DISTRIBUTION', 'NETWORK EVOLUTION', 'INTER ANALYSIS', 'CLOUD ANALYSIS']

contains

  !> Counterpart of a command of POSTPRO.DAT: one of `postpro_counterparts`.
  pure function postpro_counterpart(command) result(counterpart)
    character(len=*), intent(in) :: command !! the command
    character(len=:), allocatable :: counterpart

    counterpart = 'nothing'
    if (any(in_record == command)) counterpart = 'record'
    if (any(in_tracks == command)) counterpart = 'track'
    if (command == one_pair .or. command == list_of_pairs) counterpart = 'interface'
    if (any(in_pictures == command)) counterpart = 'pictures'
  end function postpro_counterpart

  !> One warning: what a run writes in place of the output of the commands of POSTPRO.DAT.
  subroutine warn_of_postpro(folder, diagnostics)
    character(len=*), intent(in) :: folder !! DATBOX folder
    type(diagnostics_t), intent(inout) :: diagnostics !! warnings gathered
    type(datbox_file_t) :: file
    character(len=:), allocatable :: sentence
    integer :: i

    call open_datbox_file(file, folder, 'POSTPRO.DAT', .false., diagnostics)
    sentence = ''
    do i = 1, size(postpro_counterparts)
      call add_clause(file, trim(postpro_counterparts(i)), sentence)
    end do
    if (len(sentence) > 0) &
      call diagnostics%warn('a run writes what these commands ask for elsewhere (doc/guide/datbox.md); '//sentence(3:), &
                            file=file%path)
  end subroutine warn_of_postpro

  !> Add a clause to the warning: commands that have this counterpart.
  subroutine add_clause(file, counterpart, sentence)
    type(datbox_file_t), intent(inout) :: file
    character(len=*), intent(in) :: counterpart
    character(len=:), allocatable, intent(inout) :: sentence
    type(text_t), allocatable :: found(:)
    character(len=:), allocatable :: command
    integer :: every

    allocate (found(0))
    call go_to(file, 0)
    do while (next_command(file, command, every))
      if (postpro_counterpart(command) == counterpart) call append_word(found, command)
    end do
    if (size(found) == 0) return
    select case (counterpart)
    case ('record')
      sentence = sentence//'; in record.csv: '
    case ('track')
      sentence = sentence//'; in tracks.csv ([[track]]): '
    case ('interface')
      sentence = sentence//'; in interfaces.csv ([[interface]]): '
    case ('pictures')
      sentence = sentence//'; in pictures ([output] every): '
    case default
      sentence = sentence//'; nowhere: '
    end select
    sentence = sentence//joined(found, ', ')
  end subroutine add_clause

  !> Take keys of a deck from POSTPRO.DAT: steps between rows of the record and between pictures, bodies to track, and pairs
  !! of bodies whose contacts are summed.
  subroutine read_postpro(folder, n_bodies, settings, diagnostics)
    character(len=*), intent(in) :: folder !! DATBOX folder
    integer, intent(in) :: n_bodies !! bodies of the scene: others are not tracked
    type(datbox_settings_t), intent(inout) :: settings !! keys found, added to those that are there
    type(diagnostics_t), intent(inout) :: diagnostics !! warnings gathered
    type(datbox_file_t) :: file
    character(len=:), allocatable :: command
    integer :: every, record_every, pictures_every

    call open_datbox_file(file, folder, 'POSTPRO.DAT', .false., diagnostics)
    record_every = huge(1)
    pictures_every = huge(1)
    do while (next_command(file, command, every))
      select case (postpro_counterpart(command))
      case ('record')
        record_every = min(record_every, every)
      case ('track')
        record_every = min(record_every, every)
        call track_bodies(file, command, n_bodies, settings)
      case ('interface')
        record_every = min(record_every, every)
        call pair_bodies(file, command, n_bodies, settings)
      case ('pictures')
        pictures_every = min(pictures_every, every)
      end select
    end do
    if (pictures_every < huge(1)) call settings%put('output.every', to_text(pictures_every), 'POSTPRO.DAT')
    if (record_every < huge(1)) call settings%put('output.record_every', to_text(record_every), 'POSTPRO.DAT')
  end subroutine read_postpro

  !> Go to the next command and behind its line STEP; false at the end. A command is whatever stands before such a line.
  logical function next_command(file, command, every) result(found)
    type(datbox_file_t), intent(inout) :: file !! file to read on
    character(len=:), allocatable, intent(inout) :: command !! the command
    integer, intent(out) :: every !! steps between two rows
    logical :: is_number

    found = .true.
    every = 1
    command = ''
    do while (next_line(file))
      if (columns(file, 1, 3) == 'END') exit
      if (columns(file, 1, 4) == 'STEP' .and. len(command) > 0) then
        call read_integer(trim(adjustl(columns(file, 5, width))), every, is_number)
        if (.not. is_number .or. every < 1) every = 1
        return
      end if
      command = trim(columns(file, 1, width))
    end do
    found = .false.
  end function next_command

  !> Track the bodies that the data of a command list: a count and their numbers, or sets of such lists, or numbers from one to
  !! another.
  subroutine track_bodies(file, command, n_bodies, settings)
    type(datbox_file_t), intent(inout) :: file
    character(len=*), intent(in) :: command
    integer, intent(in) :: n_bodies
    type(datbox_settings_t), intent(inout) :: settings
    integer :: groups, members, first, last, i, k, body

    groups = 1
    if (command == 'NEW RIGID SETS' .or. command == 'NEW BOUNDED SETS') groups = next_number(file)
    do i = 1, groups
      if (command == 'NEW BOUNDED SETS') then
        first = next_number(file)
        last = next_number(file)
        do body = max(1, first), min(last, n_bodies, max(1, first) + most_tracked - 1)
          call settings%track(body)
        end do
        if (last < 1) return
        cycle
      end if
      members = next_number(file)
      do k = 1, members
        body = next_number(file)
        if (body < 1) return
        if (body <= n_bodies) call settings%track(body)
      end do
    end do
  end subroutine track_bodies

  !> Sum the contacts of the pairs that the data of a command list: the kind of contact and a body on each of two lines, or a count
  !! and two bodies per line.
  subroutine pair_bodies(file, command, n_bodies, settings)
    type(datbox_file_t), intent(inout) :: file
    character(len=*), intent(in) :: command
    integer, intent(in) :: n_bodies
    type(datbox_settings_t), intent(inout) :: settings
    integer :: pairs, pair(2), i

    pairs = 1
    if (command == list_of_pairs) pairs = next_number(file)
    if (command == one_pair) then
      if (.not. next_line(file)) return
    end if
    do i = 1, pairs
      if (command == one_pair) then
        pair(1) = next_number(file)
        pair(2) = next_number(file)
      else
        pair = next_numbers(file)
      end if
      if (any(pair < 1)) return
      if (all(pair <= n_bodies) .and. pair(1) /= pair(2)) call settings%add_pair(pair)
    end do
  end subroutine pair_bodies

  !> The two whole numbers of the next line; 0 where there are none.
  function next_numbers(file) result(numbers)
    type(datbox_file_t), intent(inout) :: file
    integer :: numbers(2)
    character(len=:), allocatable :: words
    logical :: is_number(2)
    integer :: blank

    numbers = 0
    if (.not. next_line(file)) return
    words = trim(adjustl(columns(file, 1, width)))
    if (index(words, ':') > 0) words = trim(words(:index(words, ':') - 1))
    blank = index(words//' ', ' ')
    call read_integer(words(:blank - 1), numbers(1), is_number(1))
    words = adjustl(words(min(blank, len(words) + 1):))
    call read_integer(words(:index(words//' ', ' ') - 1), numbers(2), is_number(2))
    if (all(is_number)) return
    numbers = 0
    call go_to(file, file%at - 1)
  end function next_numbers

  !> The whole number of the next line; 0 where there is none.
  integer function next_number(file) result(number)
    type(datbox_file_t), intent(inout) :: file
    character(len=:), allocatable :: word
    logical :: is_number

    number = 0
    if (.not. next_line(file)) return
    word = trim(adjustl(columns(file, 1, width)))
    word = word(:scan(word//' ', ' :') - 1)
    call read_integer(word, number, is_number)
    if (.not. is_number) call go_to(file, file%at - 1)
  end function next_number
end module sg_datbox_postpro
