!> Checks of DATBOX folders that are spoilt on purpose: a good one, with one thing wrong at a time.
module datbox_tests
  use harness, only: tests_t
  use sg_datbox, only: read_datbox
  use sg_error, only: diagnostics_t
  use sg_scene, only: scene_t
  use sg_system, only: make_folder
  use sg_text, only: to_text
  use written_files, only: put_lines
  implicit none
  private
  public :: datbox_tests_t

  !> Length of a line
  integer, parameter, public :: width = 104
  !> Do not look at the line of the mistake
  integer, parameter, public :: any_place = -1
  integer, parameter :: most_files = 7, most_lines = 60

  !> The checks, and the good folder line by line
  type, extends(tests_t) :: datbox_tests_t
    character(len=40) :: folder = ''
    integer :: n_files = 0
    character(len=14) :: names(most_files) = ''
    integer :: n_lines(most_files) = 0
    character(len=width) :: lines(most_lines, most_files) = ''
  contains
    procedure :: begin => datbox_tests_begin
    procedure :: keep => datbox_tests_keep
    procedure :: take => datbox_tests_take
    procedure :: put => datbox_tests_put
    procedure :: write_good => datbox_tests_write_good
    procedure :: check_good => datbox_tests_check_good
    procedure :: refuse => datbox_tests_refuse
    procedure :: expect => datbox_tests_expect
  end type datbox_tests_t

contains

  !> Name the folder, and keep the lines of the files that every good one has.
  subroutine datbox_tests_begin(self, folder, bulk, tact, bodies, drives, state)
    class(datbox_tests_t), intent(inout) :: self
    character(len=*), intent(in) :: folder !! folder to write
    character(len=*), intent(in) :: bulk(:), tact(:), bodies(:), drives(:), state(:) !! lines of its files

    self%folder = folder
    call self%keep('BULK_BEHAV.DAT', bulk)
    call self%keep('TACT_BEHAV.DAT', tact)
    call self%keep('BODIES.DAT', bodies)
    call self%keep('DRV_DOF.DAT', drives)
    call self%keep('DOF.INI', state)
  end subroutine datbox_tests_begin

  !> Keep the lines of a file of the good folder.
  subroutine datbox_tests_keep(self, name, lines)
    class(datbox_tests_t), intent(inout) :: self
    character(len=*), intent(in) :: name !! file
    character(len=*), intent(in) :: lines(:) !! its lines

    self%n_files = self%n_files + 1
    self%names(self%n_files) = name
    self%n_lines(self%n_files) = size(lines)
    self%lines(:size(lines), self%n_files) = lines
  end subroutine datbox_tests_keep

  !> Take the lines of one file of the good folder.
  subroutine datbox_tests_take(self, name, lines)
    class(datbox_tests_t), intent(in) :: self
    character(len=*), intent(in) :: name !! file
    character(len=width), allocatable, intent(out) :: lines(:) !! its lines
    integer :: i

    i = findloc(self%names, name, 1)
    allocate (lines(self%n_lines(i)))
    lines = self%lines(:self%n_lines(i), i)
  end subroutine datbox_tests_take

  !> Write a file of the folder.
  subroutine datbox_tests_put(self, name, lines)
    class(datbox_tests_t), intent(in) :: self
    character(len=*), intent(in) :: name !! file
    character(len=*), intent(in) :: lines(:) !! its lines

    call put_lines(trim(self%folder)//'/'//name, lines)
  end subroutine datbox_tests_put

  !> Write the good folder.
  subroutine datbox_tests_write_good(self)
    class(datbox_tests_t), intent(in) :: self
    integer :: i

    if (.not. make_folder(trim(self%folder))) error stop 'no folder'
    do i = 1, self%n_files
      call self%put(trim(self%names(i)), self%lines(:self%n_lines(i), i))
    end do
  end subroutine datbox_tests_write_good

  !> The good folder has no mistake; were it otherwise, nothing else would mean anything.
  subroutine datbox_tests_check_good(self, spare_laws)
    class(datbox_tests_t), intent(inout) :: self
    integer, intent(in), optional :: spare_laws !! laws that no see table names, the only thing to warn of; none when absent
    type(scene_t) :: scene
    type(diagnostics_t) :: diagnostics

    call self%write_good()
    call read_datbox(trim(self%folder), scene, diagnostics)
    call diagnostics%print(6)
    call self%equal(diagnostics%count(), 0, 'the good folder')
    call self%check(allocated(diagnostics%warnings) .eqv. present(spare_laws), 'nothing else to warn of')
    if (.not. present(spare_laws)) return
    call self%equal(size(diagnostics%warnings), 1, 'one kind of warning')
    call self%check(index(diagnostics%warnings(1)%message, 'no see table names the contact law') == 1, 'of laws')
    call self%equal(diagnostics%warnings(1)%count, spare_laws, 'as many as there are')
  end subroutine datbox_tests_check_good

  !> Put another text in place of one line of one file: the first mistake must hold a fragment and stand at a place.
  subroutine datbox_tests_refuse(self, name, line, text, fragment, at_line, at_column, in_file)
    class(datbox_tests_t), intent(inout) :: self
    character(len=*), intent(in) :: name !! file to spoil
    integer, intent(in) :: line !! line to replace
    character(len=*), intent(in) :: text !! what to put there
    character(len=*), intent(in) :: fragment !! part of the message expected
    integer, intent(in) :: at_line !! line expected
    integer, intent(in), optional :: at_column !! column expected
    character(len=*), intent(in), optional :: in_file !! file that is blamed, when not the one spoilt
    character(len=width), allocatable :: lines(:)

    call self%write_good()
    call self%take(name, lines)
    lines(line) = text
    call self%put(name, lines)
    if (present(in_file)) then
      call self%expect(in_file, fragment, at_line, at_column)
    else
      call self%expect(name, fragment, at_line, at_column)
    end if
  end subroutine datbox_tests_refuse

  !> Read the folder as it stands and check its first mistake.
  subroutine datbox_tests_expect(self, name, fragment, at_line, at_column)
    class(datbox_tests_t), intent(inout) :: self
    character(len=*), intent(in) :: name !! file that is blamed
    character(len=*), intent(in) :: fragment !! part of the message expected
    integer, intent(in) :: at_line !! line expected, or `any_place`
    integer, intent(in), optional :: at_column !! column expected
    type(scene_t) :: scene
    type(diagnostics_t) :: diagnostics
    character(len=:), allocatable :: what

    call read_datbox(trim(self%folder), scene, diagnostics)
    what = name//' '//to_text(at_line)//' "'//fragment//'"'
    call self%check(diagnostics%count() > 0, 'no mistake found: '//what)
    if (diagnostics%count() == 0) return
    associate (first => diagnostics%errors(1))
      call self%check(index(first%message, fragment) > 0, what//' but said: '//first%sentence())
      call self%check(index(first%file, name) > 0, what//' in the file '//first%file)
      if (at_line /= any_place) call self%equal(first%line, at_line, 'line of '//what)
      if (present(at_column)) call self%equal(first%column, at_column, 'column of '//what)
    end associate
  end subroutine datbox_tests_expect
end module datbox_tests
