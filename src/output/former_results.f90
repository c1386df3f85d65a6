!> What a folder of results holds before a run writes there: results of other runs, which are not replaced unasked, and files that
!! the run reads, which are not replaced at all.
!!
!! Other results are those of another deck (the effective decks differ), or those of this deck from a run that has not ended but
!! left a checkpoint. Results that the same deck would give again are replaced.
module sg_former_results
  use sg_error, only: error_t, fail
  use sg_restart_files, only: restarts_of
  use sg_run_lock, only: lock_name
  use sg_system, only: file_exists, real_path, remove_file
  use sg_text, only: joined, read_lines, text_t
  implicit none
  private
  public :: check_former, check_inputs, content_of, has_results, is_within, remove_results

  !> What a run writes under fixed names
  character(len=*), parameter :: result_names(30) = [character(len=23) :: 'run.json', 'record.csv', 'effective.toml', &
    'numbers.tag', 'needs.json', 'trace.csv', 'trace_steps.csv', 'spectrum.csv', 'radial_distribution.csv', &
    'structure_factor.csv', 'tracks.csv', 'walls.csv', 'regions.csv', 'subdomains.csv', 'interfaces.csv', &
    'field_1.vtkhdf', 'field_2.vtkhdf', 'field_3.vtkhdf', 'field_4.vtkhdf', &
    'bodies.vtkhdf', 'shapes.vtkhdf', 'contacts.vtkhdf', 'bodies.xmf', 'shapes.xmf', 'contacts.xmf', 'interfaces.vtkhdf', &
    'interfaces.xmf', 'restart_a.h5', &
    'restart_b.h5', lock_name]

contains

  !> Does a folder hold results of any run?
  logical function has_results(folder)
    character(len=*), intent(in) :: folder !! folder to look at
    character(len=12), parameter :: names(4) = [character(len=12) :: 'run.json', 'record.csv', 'restart_a.h5', 'restart_b.h5']
    integer :: i

    has_results = .false.
    do i = 1, size(names)
      has_results = has_results .or. file_exists(folder//'/'//trim(names(i)))
    end do
  end function has_results

  !> Remove the results of a former run: none of them may pass for one of the run that begins.
  subroutine remove_results(folder)
    character(len=*), intent(in) :: folder !! folder of results, locked
    integer :: i

    do i = 1, size(result_names)
      if (result_names(i) /= lock_name) call remove_file(folder//'/'//trim(result_names(i)))
    end do
  end subroutine remove_results

  !> Refuse to replace other results.
  subroutine check_former(folder, deck_text, error)
    character(len=*), intent(in) :: folder !! folder of results, which may not exist
    character(len=*), intent(in) :: deck_text !! effective deck of the run that is to write there
    type(error_t), allocatable, intent(out) :: error !! set when the folder holds other results
    character(len=:), allocatable :: on
    type(text_t), allocatable :: checkpoints(:)
    logical :: has_checkpoint

    if (.not. has_results(folder)) return
    checkpoints = restarts_of(folder)
    has_checkpoint = size(checkpoints) > 0
    on = ''
    if (has_checkpoint) on = ', --restart '//folder//' goes on from its checkpoint'
    if (content_of(folder//'/effective.toml') /= deck_text) then
      call fail(error, 'this folder holds results of another deck: --output names another folder'//on// &
                ', --force replaces them', file=folder)
    else if (has_checkpoint .and. index(content_of(folder//'/run.json'), '"status": "done"') == 0) then
      call fail(error, 'this folder holds a run that has not ended: --restart '//folder// &
                ' goes on from its checkpoint, --force begins again', file=folder)
    end if
  end subroutine check_former

  !> Refuse to write over a file that the run reads.
  subroutine check_inputs(folder, inputs, error)
    character(len=*), intent(in) :: folder !! folder of results
    type(text_t), intent(in) :: inputs(:) !! files that the run reads
    type(error_t), allocatable, intent(out) :: error !! set when one of them has the name of a result
    character(len=:), allocatable :: path
    integer :: i, k

    do i = 1, size(inputs)
      path = real_path(inputs(i)%s)
      if (len(path) == 0) cycle
      do k = 1, size(result_names)
        if (path /= real_path(folder//'/'//trim(result_names(k)))) cycle
        call fail(error, 'the run reads this file and would write over it: --output names another folder', file=inputs(i)%s)
        return
      end do
    end do
  end subroutine check_inputs

  !> Is a checkpoint, or the folder that holds it, that of a folder of results?
  logical function is_within(checkpoint, folder)
    character(len=*), intent(in) :: checkpoint !! file or folder
    character(len=*), intent(in) :: folder !! folder of results
    character(len=:), allocatable :: place
    logical :: is_folder

    inquire (file=checkpoint//'/.', exist=is_folder)
    place = checkpoint
    if (.not. is_folder) then
      place = checkpoint(:index(checkpoint, '/', back=.true.) - 1)
      if (index(checkpoint, '/') == 0) place = '.'
      if (index(checkpoint, '/', back=.true.) == 1) place = '/'
    end if
    place = real_path(place)
    is_within = len(place) > 0 .and. place == real_path(folder)
  end function is_within

  !> Text of a file; empty when it cannot be read.
  function content_of(file) result(text)
    character(len=*), intent(in) :: file
    character(len=:), allocatable :: text
    type(text_t), allocatable :: lines(:)
    type(error_t), allocatable :: error

    text = ''
    call read_lines(file, lines, error)
    if (.not. allocated(error)) text = joined(lines, new_line('a'))//new_line('a')
  end function content_of
end module sg_former_results
