!> `splitgrain check`: plan and expected memory of a run, and all mistakes of its deck, without the run.
module sg_check
  use sg_arguments, only: arguments_t
  use sg_comm, only: comm_t
  use sg_error, only: error_t, exit_done
  use sg_inventory, only: expected_memory
  use sg_memory, only: gigabytes
  use sg_plan, only: describe_plan
  use sg_print, only: print_line
  use sg_scene_argument, only: read_scene_argument
  use sg_simulation, only: simulation_t
  use sg_start_split, only: find_contacts
  use sg_text, only: counted, to_text
  implicit none
  private
  public :: check_command

contains

  !> Check a deck and print what it holds.
  subroutine check_command(arguments, comm, code, error)
    type(arguments_t), intent(in) :: arguments !! the command line
    type(comm_t), intent(in) :: comm !! this rank alone
    integer, intent(out) :: code !! exit code when there is no error
    type(error_t), allocatable, intent(out) :: error !! error of the command
    type(simulation_t) :: sim

    code = exit_done
    call arguments%expect('set', 1, 1, 'check DECK [--set section.key=value]', error)
    if (.not. allocated(error)) call read_scene_argument(arguments, comm, sim%scene, sim%options, code, error)
    if (allocated(error) .or. code /= exit_done) return
    call find_contacts(sim, error)
    if (allocated(error)) then
      error%file = arguments%words(1)%s
      return
    end if
    call print_counts(arguments%words(1)%s, sim)
    call print_line(describe_plan(sim%plan, sim%scene, 1, sim%options%recovery))
  end subroutine check_command

  !> Print what is not in the plan: time, laws, drives, memory.
  subroutine print_counts(file, sim)
    character(len=*), intent(in) :: file
    type(simulation_t), intent(in) :: sim

    associate (scene => sim%scene, options => sim%options)
      call print_line(file//': no mistakes')
      if (options%title /= '') call print_line('title      '//options%title)
      call print_line('deck       '//options%deck_hash)
      call print_line('time       '//to_text(options%steps)//' steps of '//to_text(options%time_step, 4)//' s')
      call print_line('rules      '//counted(size(scene%laws), 'contact law')//', '// &
        counted(size(scene%sees), 'interaction rule'))
      call print_line('imposed    '//counted(size(scene%drives), 'component')//', '//counted(size(scene%pressures), 'pressure'))
      call print_line('memory     about '//gigabytes(expected_memory(sim))//', with '// &
        counted(sim%contacts%n, 'contact')//' and '//counted(sim%pairs%n, 'pair')//' of neighbours at the start')
    end associate
  end subroutine print_counts
end module sg_check
