!> Limits of memory and time within a step: they end a run before a list, a problem or a search exceeds them.
module sg_limits
  use sg_contacts, only: drop_contacts
  use sg_error, only: error_t, exit_memory, exit_stopped, fail
  use sg_kinds, only: wp, i8
  use sg_memory, only: gigabytes, memory_t
  use sg_problem, only: growth_of_problem
  use sg_scene, only: scene_t
  use sg_simulation, only: simulation_t
  use sg_text, only: to_text
  implicit none
  private
  public :: check_limits

contains

  !> Did detection end early, or is there no room for the problem of its contacts? Then no contact is left.
  subroutine check_limits(sim, error)
    type(simulation_t), intent(inout) :: sim !! its contacts are found, and its problem is that of the last step
    type(error_t), allocatable, intent(out) :: error !! set when the run must end
    integer(i8) :: growth

    associate (scene => sim%scene, pairs => sim%pairs, contacts => sim%contacts, step => sim%step + 1)
      ! What the next step keeps of the contacts is an eighth of their problem; a checkpoint copies them.
      growth = growth_of_problem(sim%problem, sim%plan%kind, contacts%n)
      growth = growth + growth/8 + contacts%bytes_per_item()*int(contacts%n, i8)
      if (sim%options%substeps > 1) growth = growth + sim%carry%growth(contacts%n)
      if (pairs%is_late) then
        call fail(error, 'stopped by the walltime after step '//to_text(sim%step), code=exit_stopped)
      else if (pairs%is_cut) then
        call fail(error, sentence(pairs%memory, step, pairs%n_cut, 'pairs of neighbours', scene), code=exit_memory)
      else if (contacts%is_cut) then
        call fail(error, sentence(contacts%memory, step, contacts%n_cut, 'contacts', scene), code=exit_memory)
      else if (.not. contacts%memory%fits(growth)) then
        call drop_contacts(contacts)
        call fail(error, sentence(contacts%memory, step, contacts%n_cut, 'contacts with their contact problem', scene), &
                  code=exit_memory)
      end if
    end associate
  end subroutine check_limits

  !> Sentence on short memory: what does not fit, and a hint where the alert distance is long.
  function sentence(memory, step, n, what, scene)
    type(memory_t), intent(in) :: memory
    integer, intent(in) :: step, n
    character(len=*), intent(in) :: what
    type(scene_t), intent(in) :: scene
    character(len=:), allocatable :: sentence, limit
    integer(i8) :: left

    call memory%left(left, limit)
    sentence = 'step '//to_text(step)//': memory is short: '//to_text(n)//' '//what//' and more, '// &
               to_text(n/max(1, scene%bodies%n))//' per body, do not fit into the '//gigabytes(real(left, wp))//' that '//limit// &
               ' leaves'//long_alert(scene)
  end function sentence

  !> A hint where the alert distance is longer than most shapes.
  function long_alert(scene) result(hint)
    type(scene_t), intent(in) :: scene
    character(len=:), allocatable :: hint
    real(wp) :: alert, reach

    hint = ''
    if (size(scene%sees) == 0 .or. scene%contactors%n == 0) return
    alert = maxval(scene%sees%alert)
    reach = sum(scene%contactors%reach(:scene%contactors%n))/real(scene%contactors%n, wp)
    if (alert > reach) hint = '; shapes are neighbours up to the alert distance of '//to_text(alert, 3)//' m, which is '// &
                              to_text(alert/reach, 2)//' times their mean radius: make it shorter'
  end function long_alert
end module sg_limits
