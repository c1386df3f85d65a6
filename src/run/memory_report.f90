!> Memory report of a run: bytes per grain and per contact by table, libraries opened, messages, cost of a contact update.
!!
!! `run --needs` prints it at the end of a run, and writes it to needs.json.
module sg_memory_report
  use sg_assemble, only: assemble
  use sg_columns, only: fixed, padded
  use sg_detect, only: detect
  use sg_error, only: error_t
  use sg_inventory, only: list_tables
  use sg_json, only: json_t
  use sg_kernel_cost, only: compare_cost, kernel_cost_t
  use sg_kinds, only: wp, i8
  use sg_library, only: heap_bytes, is_open
  use sg_library_files, only: library_file, on_demand
  use sg_methods, only: is_swept
  use sg_motion, only: predict
  use sg_print, only: print_line
  use sg_simulation, only: simulation_t
  use sg_tables, only: per_body, per_contact, tables_t
  use sg_text, only: to_text
  use sg_text_files, only: replace_file
  implicit none
  private
  public :: report_memory

  !> Needs of a run, all ranks together
  type :: needs_t
    type(tables_t) :: tables
    !> Memory in use [bytes], that of tables and all other; 0 where the system has no such figure
    integer(i8) :: heap = 0
    !> Libraries that were opened
    character(len=:), allocatable :: libraries
    type(kernel_cost_t) :: cost
    !> Grains and contacts, messages between ranks
    integer :: grains = 0, contacts = 0
    real(wp) :: messages = 0
  end type needs_t

contains

  !> Print the needs of a run. The simulation has ended: it is left within a step. Collective. Where the run was stopped there is no
  !! time to measure what sweeps cost.
  subroutine report_memory(sim, is_stopped, error)
    type(simulation_t), intent(inout) :: sim !! after its last step
    logical, intent(in) :: is_stopped !! by a signal or by the walltime
    type(error_t), allocatable, intent(out) :: error !! set on all ranks when needs.json cannot be written
    type(needs_t) :: needs

    needs%heap = heap_bytes()
    call list_tables(sim, needs%tables)
    needs%grains = sim%plan%grains
    needs%contacts = sim%all_contacts
    needs%libraries = opened_libraries()
    needs%messages = real(sim%comm%traffic%messages, wp)
    if (sim%comm%size > 1) call add_ranks(needs, sim)
    if (sim%comm%size == 1 .and. is_swept(sim%options%solver%method) .and. sim%step > 0 .and. .not. is_stopped) &
      call measure_cost(sim, needs%cost)
    if (sim%comm%rank == 0) then
      if (.not. sim%options%is_quiet) call print_needs(needs)
      call write_needs(needs, sim, error)
    end if
    call sim%comm%agree(error)
  end subroutine report_memory

  !> Which of the libraries that are opened on demand are open?
  function opened_libraries() result(names)
    character(len=:), allocatable :: names
    integer :: i

    names = ''
    do i = 1, size(on_demand)
      if (is_open(library_file(on_demand(i)))) names = names//' '//trim(on_demand(i))
    end do
    names = trim(adjustl(names))
  end function opened_libraries

  !> Add memory and messages of other ranks. Collective.
  subroutine add_ranks(needs, sim)
    type(needs_t), intent(inout) :: needs
    type(simulation_t), intent(inout) :: sim

    associate (list => needs%tables%list(:needs%tables%n))
      call sim%comm%sum(list%bytes)
      list%is_there = sim%comm%any(list%is_there)
    end associate
    if (.not. sim%comm%leads_process()) needs%heap = 0
    call sim%comm%sum(needs%heap)
    call sim%comm%sum(needs%messages)
  end subroutine add_ranks

  !> Begin one more step, and solve its problem by the bare kernel and by the solver, with as many sweeps as a step had.
  subroutine measure_cost(sim, cost)
    type(simulation_t), intent(inout) :: sim
    type(kernel_cost_t), intent(out) :: cost
    integer :: n_sweeps, batch

    call predict(sim%scene, sim%time(), sim%options%substep_length(), sim%options%theta)
    call detect(sim%scene, sim%pairs, sim%history, sim%contacts)
    call assemble(sim%scene, sim%plan, sim%pairs, sim%contacts, sim%options%substep_length(), sim%problem)
    batch = sim%options%solver%typical_gap()
    n_sweeps = nint(real(sim%totals%sweeps, wp)/real(max(1, sim%totals%steps)*batch, wp))*batch
    call compare_cost(sim%problem, sim%options%solver, max(batch, n_sweeps), cost)
  end subroutine measure_cost

  !> Print the needs: one line per owner of tables, with the names of those that are there.
  subroutine print_needs(needs)
    type(needs_t), intent(in) :: needs
    character(len=:), allocatable :: names, absent
    integer(i8) :: bytes
    integer :: i, n

    call print_line('needs      '//to_text(needs%grains)//' grains, '//to_text(needs%contacts)//' contacts')
    absent = ''
    names = ''
    bytes = 0
    n = needs%tables%n
    do i = 1, n
      associate (table => needs%tables%list(i))
        if (table%is_there) names = names//' '//trim(table%name)
        if (.not. table%is_there) absent = absent//' '//trim(table%owner)//'.'//trim(table%name)
        bytes = bytes + table%bytes
        if (i < n) then
          if (needs%tables%list(i + 1)%owner == table%owner .and. needs%tables%list(i + 1)%per == table%per) cycle
        end if
        if (bytes > 0) call print_line(padded(trim(table%owner), 11)//share(needs, bytes, table%per)// &
                                       trim(merge(' B per grain:  ', ' B per contact:', table%per == per_body))//names)
      end associate
      names = ''
      bytes = 0
    end do
    call print_line('left out  '//absent)
    call print_line('bytes      '//share(needs, needs%tables%bytes_per(per_body), per_body)//' per grain, '// &
      share(needs, needs%tables%bytes_per(per_contact), per_contact)//' per contact; tables '// &
      fixed(real(table_bytes(needs), wp)/1e6_wp, 2)//' MB, all memory in use '//fixed(real(needs%heap, wp)/1e6_wp, 2)//' MB')
    if (len(needs%libraries) == 0) then
      call print_line('libraries  optional ones loaded: none')
    else
      call print_line('libraries  optional ones loaded: '//needs%libraries)
    end if
    call print_line('messages   '//to_text(nint(needs%messages, i8)))
    if (needs%cost%visited > 0) call print_line('update     bare kernel '// &
      fixed(1e9_wp*needs%cost%kernel, 2)//' ns, sweeps '//fixed(needs%cost%sweeps/needs%cost%kernel, 2)//' and solver '// &
      fixed(needs%cost%solver/needs%cost%kernel, 2)//' times that ('//to_text(needs%cost%n_sweeps)//' sweeps over '// &
      to_text(needs%cost%visited)//' contacts)')
  end subroutine print_needs

  !> Bytes of an item, as text.
  function share(needs, bytes, per) result(text)
    type(needs_t), intent(in) :: needs
    integer(i8), intent(in) :: bytes
    integer, intent(in) :: per
    character(len=:), allocatable :: text

    text = to_text(nint(per_item(needs, bytes, per)))
  end function share

  !> Bytes of an item: a grain or a contact.
  pure real(wp) function per_item(needs, bytes, per)
    type(needs_t), intent(in) :: needs
    integer(i8), intent(in) :: bytes
    integer, intent(in) :: per

    per_item = real(bytes, wp)/real(max(1, merge(needs%grains, needs%contacts, per == per_body)), wp)
  end function per_item

  !> Bytes of all tables.
  pure integer(i8) function table_bytes(needs)
    type(needs_t), intent(in) :: needs

    table_bytes = needs%tables%bytes_per(per_body) + needs%tables%bytes_per(per_contact)
  end function table_bytes

  !> Write needs.json: bytes of each table that is there, then all other figures.
  subroutine write_needs(needs, sim, error)
    type(needs_t), intent(in) :: needs
    type(simulation_t), intent(in) :: sim
    type(error_t), allocatable, intent(out) :: error
    type(json_t) :: json
    integer :: i

    do i = 1, needs%tables%n
      associate (table => needs%tables%list(i))
        if (table%is_there) call json%add(trim(table%owner)//'.'//trim(table%name), table%bytes)
      end associate
    end do
    call json%add('ranks', sim%comm%n_processes())
    call json%add('steps', sim%step)
    call json%add('grains', needs%grains)
    call json%add('contacts', needs%contacts)
    call json%add('bytes_per_grain', per_item(needs, needs%tables%bytes_per(per_body), per_body))
    call json%add('bytes_per_contact', per_item(needs, needs%tables%bytes_per(per_contact), per_contact))
    call json%add('table_bytes', table_bytes(needs))
    call json%add('memory_bytes', needs%heap)
    call json%add('libraries', needs%libraries)
    call json%add('messages', nint(needs%messages, i8))
    if (needs%cost%visited > 0) then
      call json%add('kernel_seconds_per_update', needs%cost%kernel)
      call json%add('sweeps_over_kernel', needs%cost%sweeps/needs%cost%kernel)
      call json%add('solver_over_kernel', needs%cost%solver/needs%cost%kernel)
      call json%add('sweeps_compared', needs%cost%n_sweeps)
      call json%add('contacts_compared', needs%cost%visited)
    end if
    call replace_file(sim%options%folder//'/needs.json', json%text(), error)
  end subroutine write_needs
end module sg_memory_report
