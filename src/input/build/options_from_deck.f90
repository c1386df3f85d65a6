!> Options of a run from the sections time, solver, partition, output, restart, guard and report.
module sg_options_from_deck
  use sg_blocks, only: deck_t
  use sg_error, only: diagnostics_t, error_t
  use sg_fourier, only: find_fourier
  use sg_kinds, only: wp
  use sg_methods, only: find_method, list_couplings, list_solvers, method_t
  use sg_options, only: option_values_t
  use sg_run_options, only: criterion_names, partition_options_t, run_options_t, solver_options_t
  use sg_text, only: to_text
  use sg_threads, only: threads_are_available
  use sg_values, only: value_t
  use sg_words, only: choice_index, choices_of
  implicit none
  private
  public :: options_from_deck

contains

  !> Fill the options.
  subroutine options_from_deck(deck, options, diagnostics)
    type(deck_t), intent(in) :: deck !! checked deck
    type(run_options_t), intent(inout) :: options !! options to fill
    type(diagnostics_t), intent(inout) :: diagnostics !! what this program cannot do
    type(error_t), allocatable :: error
    type(value_t) :: value
    type(method_t), allocatable :: solvers(:)
    integer :: b, method

    b = deck%block_of('')
    options%title = on_one_line(deck%word(b, 'title'))
    options%about = deck%word(b, 'about')
    b = deck%block_of('time')
    options%time_step = deck%number(b, 'step')
    options%steps = deck%integer(b, 'steps')
    options%theta = deck%number(b, 'theta')
    options%substeps = deck%integer(b, 'substeps')
    options%recovery = deck%number(b, 'recovery')
    options%recovery_every = deck%integer(b, 'recovery_every')
    b = deck%block_of('solver')
    options%solver%method = deck%word(b, 'method')
    call list_solvers(solvers)
    method = find_method(solvers, options%solver%method)
    call solvers(method)%find_library(error)
    if (allocated(error)) call deck%complain(diagnostics, error%message, b, 'method')
    if (allocated(error)) deallocate (error)
    options%solver%criterion = choice_index(deck%word(b, 'criterion'), choices_of(criterion_names))
    options%solver%tolerance = deck%number(b, 'tolerance')
    options%solver%check_every = deck%integer(b, 'check_every')
    options%solver%maximum_sweeps = deck%integer(b, 'maximum_sweeps')
    options%solver%relaxation = deck%number(b, 'relaxation')
    options%solver%warm_start = deck%flag(b, 'warm_start')
    options%solver%leave_solved = deck%flag(b, 'leave_solved')
    options%solver%order = deck%word(b, 'order')
    options%solver%order_seed = deck%integer(b, 'order_seed')
    options%solver%threads = deck%integer(b, 'threads')
    if (options%solver%threads > 1) call check_threads(deck, b, diagnostics)
    options%solver%stop_unconverged = deck%flag(b, 'stop_unconverged')
    call partition_from_deck(deck, solvers(method), options%partition, diagnostics)
    b = deck%block_of('output')
    options%output_every = deck%integer(b, 'every')
    options%record_every = deck%integer(b, 'record_every')
    options%record_mean = deck%flag(b, 'record_mean')
    options%has_subdomain_means = deck%flag(b, 'subdomain_means')
    if (options%has_subdomain_means .and. options%record_every == 0) &
      call deck%warn(diagnostics, 'output.subdomain_means has no effect with output.record_every = 0', b, 'subdomain_means', &
                     kind='subdomain means without record')
    options%output_single = deck%word(b, 'precision') == 'single'
    options%output_compressed = deck%flag(b, 'compression')
    options%restart_every = deck%integer(deck%block_of('restart'), 'every')
    options%restart_at_end = deck%flag(deck%block_of('restart'), 'at_end')
    b = deck%block_of('guard')
    options%guard%energy = deck%word(b, 'energy')
    options%guard%energy_tolerance = deck%number(b, 'energy_tolerance')
    b = deck%block_of('report')
    options%has_spectrum = deck%flag(b, 'spectrum')
    if (options%has_spectrum) call find_fourier(error)
    if (allocated(error)) call deck%complain(diagnostics, error%message, b, 'spectrum')
    options%has_trace = deck%flag(b, 'trace')
    value = deck%value(b, 'trace_steps')
    if (value%n > 0) options%trace_steps = nint(value%numbers(:value%n))
    call structure_from_deck(deck, b, options, diagnostics)
  end subroutine options_from_deck

  !> A text without line ends and other control characters, fit for a log.
  pure function on_one_line(text) result(line)
    character(len=*), intent(in) :: text
    character(len=len(text)) :: line
    integer :: i

    line = text
    do i = 1, len(text)
      if (iachar(text(i:i)) < 32 .or. iachar(text(i:i)) == 127) line(i:i) = ' '
    end do
  end function on_one_line

  !> What is asked of the structure of the packing.
  subroutine structure_from_deck(deck, block, options, diagnostics)
    type(deck_t), intent(in) :: deck
    integer, intent(in) :: block
    type(run_options_t), intent(inout) :: options
    type(diagnostics_t), intent(inout) :: diagnostics
    type(value_t) :: value
    type(error_t), allocatable :: error
    integer :: d

    options%has_structure = deck%flag(block, 'structure')
    options%structure_every = deck%integer(block, 'structure_every')
    value = deck%value(block, 'structure_box')
    allocate (options%structure_box(value%n))
    if (value%n > 0) options%structure_box = value%numbers(:value%n)
    d = value%n/2
    if (any(options%structure_box(:d) >= options%structure_box(d + 1:))) then
      call deck%complain(diagnostics, 'a box is given by its least, then its largest coordinates', block, 'structure_box')
    end if
    if (options%has_structure) call find_fourier(error)
    if (allocated(error)) call deck%complain(diagnostics, error%message, block, 'structure')
  end subroutine structure_from_deck

  !> Threads need a program that has them.
  subroutine check_threads(deck, block, diagnostics)
    type(deck_t), intent(in) :: deck
    integer, intent(in) :: block
    type(diagnostics_t), intent(inout) :: diagnostics

    if (threads_are_available()) return
    call deck%complain(diagnostics, 'this program was built without OpenMP, which more than one thread needs', block, 'threads')
  end subroutine check_threads

  !> Fill the options of the decomposition.
  subroutine partition_from_deck(deck, solver, options, diagnostics)
    type(deck_t), intent(in) :: deck
    type(method_t), intent(in) :: solver
    type(partition_options_t), intent(inout) :: options
    type(diagnostics_t), intent(inout) :: diagnostics
    type(value_t) :: value
    type(method_t), allocatable :: couplings(:)
    type(error_t), allocatable :: error
    integer :: b, gluing

    b = deck%block_of('partition')
    options%parts = deck%integer(b, 'parts')
    if (options%parts > 0 .and. options%parts < deck%ranks) &
      call deck%complain(diagnostics, to_text(options%parts)//' subdomains cannot be dealt to '//to_text(deck%ranks)// &
                         ' ranks: each needs one', b, 'parts')
    options%split = deck%word(b, 'split')
    options%gluing = deck%word(b, 'gluing')
    call list_couplings(couplings)
    gluing = find_method(couplings, options%gluing)
    call couplings(gluing)%find_library(error)
    if (allocated(error)) call deck%complain(diagnostics, error%message, b, 'gluing')
    if (allocated(solver%coupled)) then
      if (.not. extends_type_of(solver%coupled, couplings(gluing)%coupled)) &
        call deck%warn(diagnostics, '"gluing" is ignored with solver.method = "'//trim(solver%name)// &
                       '", which has a coupling of its own', b, 'gluing')
    end if
    value = deck%value(b, 'boxes')
    if (value%n > deck%dimension) then
      call deck%complain(diagnostics, 'boxes has '//to_text(value%n)//' numbers, but there are '//to_text(deck%dimension)// &
                         ' axes', b, 'boxes')
    else if (value%n > 0) then
      ! Axes that are left out have one box.
      options%boxes = 1
      options%boxes(:value%n) = nint(value%numbers(:value%n))
    end if
    value = deck%value(b, 'sweeps')
    options%sweeps = nint(value%numbers(:value%n))
    options%every = deck%integer(b, 'every')
    options%imbalance = deck%number(b, 'imbalance')
    call own_options(deck, deck%block_of('partition.'//trim(options%gluing)), options%own)
  end subroutine partition_from_deck

  !> Values of the options that a method alone has, for the method itself.
  subroutine own_options(deck, block, values)
    type(deck_t), intent(in) :: deck
    integer, intent(in) :: block !! its block; 0 where it has no options
    type(option_values_t), intent(inout) :: values
    type(value_t) :: value
    real(wp) :: number
    integer :: k

    if (block == 0) return
    associate (section => deck%table%sections(deck%blocks(block)%section))
      do k = section%first, section%last
        associate (name => deck%table%keys(k)%name)
          value = deck%value(block, trim(name))
          number = 0
          if (value%n > 0) number = value%numbers(1)
          call values%put(trim(name), number, deck%word(block, trim(name)))
        end associate
      end do
    end associate
  end subroutine own_options
end module sg_options_from_deck
