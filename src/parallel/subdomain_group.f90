!> Groups of ranks that may be subdomains of a scene which share processes: which process has which, and letters within one.
!!
!! The subdomains of a process are coroutines (sg_coroutines) and share a board (sg_board); those of process p of P are the
!! block of numbers from p n/P to (p + 1) n/P - 1. Without a board a rank is a process.
module sg_subdomain_group
  use sg_board, only: board_t
  use sg_kinds, only: i8, wp
  use sg_process_swap, only: first_subdomain
  use sg_ranks, only: ranks_t
  implicit none
  private
  public :: subdomain_group_t

  !> Ranks that may be subdomains of few processes
  type, extends(ranks_t) :: subdomain_group_t
    !> The board of this process, the place of this subdomain on it, and the processes
    type(board_t), pointer :: board => null()
    integer :: place = 0
    type(ranks_t) :: processes
  contains
    procedure :: is_virtual => group_is_virtual
    procedure :: n_processes => group_n_processes
    procedure :: n_here => group_n_here
    procedure :: leads_process => group_leads_process
    procedure :: join => group_join
    procedure :: stay_here => group_stay_here
    procedure :: first_of => group_first_of
    procedure :: process_of => group_process_of
    procedure :: is_here => group_is_here
    procedure :: tag_between => group_tag_between
    procedure :: post => group_post
    procedure :: expect => group_expect
    procedure :: take => group_take
  end type subdomain_group_t

contains

  !> Are the ranks subdomains that share processes, or may share them?
  pure logical function group_is_virtual(self) result(is_virtual)
    class(subdomain_group_t), intent(in) :: self

    is_virtual = associated(self%board)
  end function group_is_virtual

  !> Number of processes.
  pure integer function group_n_processes(self) result(n)
    class(subdomain_group_t), intent(in) :: self

    n = self%size
    if (associated(self%board)) n = self%processes%size
  end function group_n_processes

  !> Number of ranks of this process.
  pure integer function group_n_here(self) result(n)
    class(subdomain_group_t), intent(in) :: self

    n = 1
    if (associated(self%board)) n = self%board%n
  end function group_n_here

  !> Is this the first rank of its process?
  pure logical function group_leads_process(self) result(leads)
    class(subdomain_group_t), intent(in) :: self

    leads = self%place == 0
  end function group_leads_process

  !> Become a subdomain of this process.
  subroutine group_join(self, board, place, processes, n)
    class(subdomain_group_t), intent(inout) :: self
    type(board_t), intent(in), target :: board !! board of the process; it must stay where it is
    integer, intent(in) :: place !! which of the subdomains of this process, from 0
    class(ranks_t), intent(in) :: processes !! the processes
    integer, intent(in) :: n !! subdomains of all processes

    self%board => board
    self%place = place
    self%processes%rank = processes%rank
    self%processes%size = processes%size
    self%size = n
    self%rank = self%first_of(processes%rank) + place
  end subroutine group_join

  !> Narrow the group to the subdomains of this process; to this rank alone where a rank is a process.
  subroutine group_stay_here(self)
    class(subdomain_group_t), intent(inout) :: self

    self%rank = self%place
    self%size = 1
    if (associated(self%board)) self%size = self%board%n
    self%processes%rank = 0
    self%processes%size = 1
  end subroutine group_stay_here

  !> First subdomain of a process of this group.
  pure integer function group_first_of(self, process) result(first)
    class(subdomain_group_t), intent(in) :: self
    integer, intent(in) :: process !! the process, from 0

    first = first_subdomain(process, self%processes%size, self%size)
  end function group_first_of

  !> Process of a rank.
  pure integer function group_process_of(self, rank) result(process)
    class(subdomain_group_t), intent(in) :: self
    integer, intent(in) :: rank !! any rank

    process = rank
    if (.not. associated(self%board)) return
    process = int(int(rank, i8)*int(self%processes%size, i8)/int(self%size, i8))
    do while (self%first_of(process + 1) <= rank)
      process = process + 1
    end do
  end function group_process_of

  !> Is a rank another subdomain of this process?
  pure logical function group_is_here(self, rank) result(is_here)
    class(subdomain_group_t), intent(in) :: self
    integer, intent(in) :: rank !! any rank

    is_here = associated(self%board)
    if (is_here) is_here = self%process_of(rank) == self%processes%rank
  end function group_is_here

  !> Tag of messages from one rank to another, one for each pair of subdomains of two processes.
  pure integer function group_tag_between(self, from, to) result(tag)
    class(subdomain_group_t), intent(in) :: self
    integer, intent(in) :: from !! sender
    integer, intent(in) :: to !! receiver
    integer :: most

    tag = 1
    if (.not. associated(self%board)) return
    most = self%size/self%processes%size + 1
    tag = 1 + (from - self%first_of(self%process_of(from)))*most + to - self%first_of(self%process_of(to))
  end function group_tag_between

  !> Send items to another subdomain of this process.
  subroutine group_post(self, to, items)
    class(subdomain_group_t), intent(in) :: self
    integer, intent(in) :: to !! its rank
    real(wp), intent(in) :: items(:, :) !! what to send; it is copied

    call self%board%post(self%place, to - self%rank + self%place, items)
  end subroutine group_post

  !> Number of the letter that this rank expects next from another subdomain of this process.
  integer(i8) function group_expect(self, from) result(number)
    class(subdomain_group_t), intent(in) :: self
    integer, intent(in) :: from !! its rank

    number = self%board%expect(from - self%rank + self%place, self%place)
  end function group_expect

  !> Take a letter from another subdomain of this process, where it has come.
  logical function group_take(self, from, number, items) result(has_come)
    class(subdomain_group_t), intent(in) :: self
    integer, intent(in) :: from !! its rank
    integer(i8), intent(in) :: number !! number of the letter
    real(wp), intent(inout) :: items(:, :) !! what was sent, unchanged where nothing has come

    has_come = self%board%take(from - self%rank + self%place, self%place, number, items)
  end function group_take
end module sg_subdomain_group
