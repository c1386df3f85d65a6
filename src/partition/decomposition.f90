!> The decomposition of a scene over ranks, from its beginning on: the owner of each body, and how that changes with the motion.
!!
!! Bodies keep their owners until grains are repartitioned (every so many steps, or when the loads are uneven). Lists of neighbours
!! are rebuilt on all ranks at once; copies with them when grains have moved through the margin of the last ones: then contacts
!! with their impulses follow their owners. Gluing impulses are no state: they follow from the impulses of the contacts
!! (doc/theory/decomposition.md).
module sg_decomposition
  use sg_boxes, only: choose_boxes, split_boxes
  use sg_carried_copies, only: carried_copies_t
  use sg_comm, only: comm_t
  use sg_contact_migration, only: distribute_contacts, distribute_start_contacts, send_contacts, unpack_contacts
  use sg_contacts, only: contacts_t
  use sg_error, only: error_t
  use sg_halo, only: make_halo
  use sg_halo_margin, only: halo_margin_t
  use sg_history, only: history_t, resume_history, start_history
  use sg_kinds, only: wp, i4, i8
  use sg_list_margins, only: fitting_skin, neighbours_are_stale
  use sg_load, only: imbalance, own_load
  use sg_local_numbers, only: local_contactor
  use sg_migrate, only: migrate
  use sg_neighbour_list, only: neighbours_t
  use sg_owner_sums, only: copy_from_owner
  use sg_owners, only: counts_on
  use sg_parcels, only: parcel_t
  use sg_rank_bounds, only: body_reach
  use sg_renumber, only: renumber_contacts
  use sg_repartition, only: repartition_grains
  use sg_replicated_data, only: keep_replicated, localise, replicated_data_t
  use sg_run_options, only: partition_options_t
  use sg_scene, only: scene_t, start_contact_t
  use sg_share, only: piece_of
  use sg_subdomain, only: subdomain_t
  use sg_tables, only: per_contact, tables_t
  implicit none
  private
  public :: decomposition_t

  !> A body that is no grain is replicated, held by all ranks, when it reaches farther than so many mean grains
  real(wp), parameter :: replicated_reach = 8

  !> One rank's side of the decomposition
  type :: decomposition_t
    !> The ranks that share each body
    type(subdomain_t) :: subdomain
    !> Drives and pressures of the whole scene, which all ranks keep
    type(replicated_data_t) :: replicated
    !> Options of the deck
    type(partition_options_t) :: options
    !> Steps since the split was made, largest load of a rank over the mean one at the last look
    integer :: age = 0
    real(wp) :: imbalance = 1
    !> How far copies reach
    type(halo_margin_t), private :: margin
    !> Contacts known before the first step, with the numbers of the whole scene: read from a deck, or from a restart file
    type(start_contact_t), allocatable, private :: start_contacts(:)
    type(parcel_t), private :: resumed
    logical, private :: is_first = .true., is_resumed = .false.
  contains
    procedure :: begin => decomposition_begin
    procedure :: update => decomposition_update
    procedure :: list_tables => decomposition_list_tables
  end type decomposition_t

contains

  !> Split a scene that all ranks hold whole, or of which each holds a share: afterwards each holds its part. Collective.
  subroutine decomposition_begin(self, scene, contacts, is_resumed, options, comm, error)
    class(decomposition_t), intent(inout) :: self
    type(scene_t), intent(inout) :: scene !! the whole scene, or a part with owners; replaced by this rank's part
    type(contacts_t), intent(in) :: contacts !! of a restart file, each on one rank, with numbers of the whole scene; or none
    logical, intent(in) :: is_resumed !! does the run go on from a restart file?
    type(partition_options_t), intent(in) :: options !! how to split
    type(comm_t), intent(inout) :: comm !! the ranks
    type(error_t), allocatable, intent(out) :: error !! set on all ranks when the deck asks for an impossible split
    integer(i4), allocatable :: owner(:)

    self%options = options
    self%subdomain%rank = comm%rank
    self%subdomain%size = comm%size
    if (.not. allocated(scene%bodies%id)) call hold_everywhere(scene, comm)
    call count_all(self%subdomain, scene, comm)
    call keep_replicated(scene, self%replicated)
    call first_owners(scene, options, comm, owner, error)
    if (allocated(error)) return
    if (allocated(scene%start_contacts)) call move_alloc(scene%start_contacts, self%start_contacts)
    call migrate(scene, owner, comm)
    ! Of a file's values of a replicated body one copy has them.
    if (scene%bodies%n_carried > 0) scene%bodies%carried(:, scene%bodies%n_own + 1:) = 0
    self%is_resumed = is_resumed
    if (is_resumed) call distribute_contacts(contacts, scene, self%subdomain%all_contactors, comm, self%resumed)
    if (allocated(self%start_contacts)) &
      call distribute_start_contacts(self%start_contacts, scene, self%subdomain%all_contactors, comm)
    call localise(self%replicated, scene)
    self%subdomain%splits = 1
  end subroutine decomposition_begin

  !> Number the bodies of a scene that all ranks hold whole, as bodies that all ranks hold; of known contacts each keeps a piece.
  subroutine hold_everywhere(scene, comm)
    type(scene_t), intent(inout) :: scene
    type(comm_t), intent(in) :: comm
    integer :: i, piece(2)

    scene%bodies%id = [(int(i, i4), i=1, scene%bodies%n)]
    scene%contactors%id = [(int(i, i4), i=1, scene%contactors%n)]
    allocate (scene%bodies%owner(scene%bodies%n), source=-1_i4)
    if (.not. allocated(scene%start_contacts)) return
    piece = piece_of(size(scene%start_contacts), comm%rank, comm%size)
    scene%start_contacts = scene%start_contacts(piece(1):piece(2))
  end subroutine hold_everywhere

  !> Bodies and contactors of the whole scene: the largest numbers.
  subroutine count_all(subdomain, scene, comm)
    type(subdomain_t), intent(inout) :: subdomain
    type(scene_t), intent(in) :: scene
    type(comm_t), intent(inout) :: comm
    integer :: most(2)

    most = [maxval([0_i4, scene%bodies%id]), maxval([0_i4, scene%contactors%id(:scene%contactors%n)])]
    call comm%maximum(most)
    subdomain%all_bodies = most(1)
    subdomain%all_contactors = most(2)
  end subroutine count_all

  !> First owners of the bodies that this rank counts as its own, by boxes about grains of one weight each; -1 of replicated
  !! bodies, and of others that all ranks hold so far and another one counts.
  subroutine first_owners(scene, options, comm, owner, error)
    type(scene_t), intent(inout) :: scene !! the replicated ones of its bodies are marked
    type(partition_options_t), intent(in) :: options
    type(comm_t), intent(inout) :: comm
    integer(i4), allocatable, intent(out) :: owner(:)
    type(error_t), allocatable, intent(out) :: error
    logical, allocatable :: is_replicated(:)
    integer(i4), allocatable :: own(:), part(:)
    integer :: i, counts(3)

    call find_replicated(scene, comm, is_replicated)
    associate (bodies => scene%bodies)
      own = pack([(int(i, i4), i=1, bodies%n)], [(counts_on(comm%rank, comm%size, bodies%owner(i), bodies%id(i)) .and. &
                                                   .not. is_replicated(i), i=1, bodies%n)])
      where (bodies%owner < 0 .and. .not. is_replicated) bodies%owner = int(comm%rank, i4)
      call choose_boxes(comm, bodies%position(:, own), comm%size, options%boxes, counts, error)
      if (allocated(error)) return
      call split_boxes(comm, bodies%position(:, own), [(1.0_wp, i=1, size(own))], bodies%id(own), counts, part)
      allocate (owner(bodies%n), source=-1_i4)
    end associate
    owner(own) = part - 1_i4
  end subroutine first_owners

  !> Bodies that all ranks go on to hold: those that carry a pressure or bound a pressed length, and large ones that are no
  !! grains.
  subroutine find_replicated(scene, comm, is_replicated)
    type(scene_t), intent(in) :: scene
    type(comm_t), intent(inout) :: comm
    logical, allocatable, intent(out) :: is_replicated(:)
    real(wp) :: reach(scene%bodies%n), sums(2)
    integer :: i

    reach = body_reach(scene, scene%bodies%n)
    associate (bodies => scene%bodies)
      sums = 0
      do i = 1, bodies%n
        if (bodies%is_grain(i) .and. counts_on(comm%rank, comm%size, bodies%owner(i), bodies%id(i))) &
          sums = sums + [1.0_wp, reach(i)]
      end do
      call comm%sum(sums)
      is_replicated = bodies%owner < 0 .and. .not. bodies%is_grain .and. reach > replicated_reach*sums(2)/max(1.0_wp, sums(1))
    end associate
    do i = 1, size(scene%pressures)
      is_replicated(scene%pressures(i)%body) = .true.
      if (all(scene%pressures(i)%between > 0)) is_replicated(scene%pressures(i)%between) = .true.
      associate (sides => reshape(scene%pressures(i)%sides, [6]))
        is_replicated(pack(sides, sides > 0)) = .true.
      end associate
    end do
  end subroutine find_replicated

  !> Bring the part of this rank up to date where any rank's list of neighbours is stale. Collective.
  subroutine decomposition_update(self, scene, pairs, history, contacts, time_step, comm, is_rebuilt, error)
    class(decomposition_t), intent(inout) :: self
    type(scene_t), intent(inout) :: scene !! this rank's part, predicted; replaced when rebuilt
    type(neighbours_t), intent(inout) :: pairs !! its list of neighbours; forgotten when rebuilt
    type(history_t), intent(inout) :: history !! contacts of the last step
    type(contacts_t), intent(inout) :: contacts !! the same
    real(wp), intent(in) :: time_step !! of a solve, turns forces of the deck into impulses [s]
    type(comm_t), intent(inout) :: comm !! the ranks
    logical, intent(out) :: is_rebuilt !! was the part rebuilt? Then predict again
    type(error_t), allocatable, intent(out) :: error !! set on all ranks when the graph cannot be split
    integer(i4), allocatable :: owner(:), former(:)
    type(parcel_t) :: migrating
    type(carried_copies_t) :: carried
    real(wp) :: skin, before
    logical :: is_split

    is_rebuilt = .false.
    if (self%subdomain%size == 1) return
    self%age = self%age + 1
    if (.not. comm%any(self%is_first .or. must_split(self) .or. neighbours_are_stale(pairs, scene))) return
    skin = common_skin(scene, pairs%substeps, comm)
    call forget_pairs(pairs, skin)
    if (.not. self%is_first) self%imbalance = imbalance(comm, own_load(contacts, scene%bodies%is_grain, scene%bodies%n_own))
    is_split = must_split(self)
    is_rebuilt = self%is_first .or. is_split
    if (.not. is_rebuilt) is_rebuilt = .not. self%margin%holds(scene, skin, comm)
    if (.not. is_rebuilt) return
    call self%margin%choose(scene, skin, comm)
    call carried%take(scene%bodies)
    before = self%imbalance
    if (is_split) then
      call new_owners(self, scene, contacts, comm, owner, error)
      if (allocated(error)) return
      call send_contacts(contacts, scene, owner, comm, migrating)
      call migrate(scene, owner, comm)
    else
      former = scene%contactors%id(:scene%contactors%n)
    end if
    call make_halo(scene, self%replicated, self%subdomain, self%margin%width, comm)
    call carried%give(scene%bodies)
    if (self%is_first) then
      call start_contacts_here(self, scene, history, contacts, time_step)
    else
      if (is_split) call unpack_contacts(migrating, scene, contacts)
      if (.not. is_split) call renumber_contacts(contacts, former, scene)
      call resume_history(history, contacts)
      if (is_split) call note_split(self, scene, contacts, before, comm)
    end if
    call self%margin%start(scene)
    self%is_first = .false.
  end subroutine decomposition_update

  !> Note how evenly ranks were loaded before a split, and are after it. Collective.
  subroutine note_split(self, scene, contacts, before, comm)
    class(decomposition_t), intent(inout) :: self
    type(scene_t), intent(in) :: scene
    type(contacts_t), intent(in) :: contacts
    real(wp), intent(in) :: before
    type(comm_t), intent(inout) :: comm
    real(wp) :: after

    after = imbalance(comm, own_load(contacts, scene%bodies%is_grain, scene%bodies%n_own))
    self%subdomain%imbalance_sums = self%subdomain%imbalance_sums + [before, after]
  end subroutine note_split

  !> Is a new split due: by its age, by the loads found last, or because there had been no graph to split yet? The same on all
  !! ranks.
  pure logical function must_split(self)
    class(decomposition_t), intent(in) :: self

    must_split = .false.
    if (self%is_first) return
    if (self%options%every > 0) must_split = self%age >= self%options%every
    must_split = must_split .or. self%imbalance > self%options%imbalance .or. &
                 (self%options%split == 'graph' .and. self%subdomain%splits == 1)
  end function must_split

  !> One skin for all ranks [m].
  real(wp) function common_skin(scene, substeps, comm) result(skin)
    type(scene_t), intent(in) :: scene
    integer, intent(in) :: substeps
    type(comm_t), intent(inout) :: comm

    skin = 0
    if (scene%bodies%n > 0 .and. scene%contactors%n > 0) skin = fitting_skin(scene, substeps, has_copies=.true.)
    call comm%maximum(skin)
  end function common_skin

  !> New owners of this rank's bodies and of its copies.
  subroutine new_owners(self, scene, contacts, comm, owner, error)
    class(decomposition_t), intent(inout) :: self
    type(scene_t), intent(in) :: scene
    type(contacts_t), intent(in) :: contacts
    type(comm_t), intent(inout) :: comm
    integer(i4), allocatable, intent(out) :: owner(:)
    type(error_t), allocatable, intent(out) :: error
    integer(i8) :: moved
    integer :: n

    call repartition_grains(comm, self%options, self%subdomain, scene%bodies, contacts, owner, error)
    if (allocated(error)) return
    n = scene%bodies%n_own
    moved = count(owner(:n) /= scene%bodies%owner(:n), kind=i8)
    call comm%sum(moved)
    owner = [owner(:n), scene%bodies%owner(n + 1:)]
    call send_to_copies(self%subdomain, owner, comm)
    self%subdomain%moved = self%subdomain%moved + real(moved, wp)
    self%subdomain%splits = self%subdomain%splits + 1
    self%age = 0
    self%imbalance = 1
  end subroutine new_owners

  !> Send a whole number of each own body to all ranks that hold copies of it.
  subroutine send_to_copies(subdomain, number, comm)
    type(subdomain_t), intent(in) :: subdomain
    integer(i4), intent(inout) :: number(:) !! of own bodies; set for copies
    type(comm_t), intent(inout) :: comm
    real(wp) :: values(1, size(number))

    values(1, :) = real(number, wp)
    call copy_from_owner(subdomain, comm, values)
    number = nint(values(1, :), i4)
  end subroutine send_to_copies

  !> The past of the first step, when copies have been made: contacts of a restart file, or those of the deck.
  subroutine start_contacts_here(self, scene, history, contacts, time_step)
    class(decomposition_t), intent(inout) :: self
    type(scene_t), intent(inout) :: scene
    type(history_t), intent(inout) :: history
    type(contacts_t), intent(inout) :: contacts
    real(wp), intent(in) :: time_step
    type(history_t) :: nothing
    integer :: k, side

    if (self%is_resumed) then
      call unpack_contacts(self%resumed, scene, contacts)
      deallocate (self%resumed%value)
      call resume_history(history, contacts)
      return
    end if
    if (.not. allocated(self%start_contacts)) return
    do k = 1, size(self%start_contacts)
      do side = 1, 2
        associate (contactor => self%start_contacts(k)%contactor(side))
          contactor = local_contactor(scene%contactors, int(contactor, i4))
        end associate
      end do
    end do
    scene%start_contacts = pack(self%start_contacts, [(all(self%start_contacts(k)%contactor > 0), k=1, size(self%start_contacts))])
    deallocate (self%start_contacts)
    ! A rank that has read the whole scene holds all of its contacts there.
    history = nothing
    call start_history(history, scene, time_step, contacts%n_components, contacts%n_internal)
  end subroutine start_contacts_here

  !> Request a new list of neighbours, with a given skin.
  subroutine forget_pairs(pairs, skin)
    type(neighbours_t), intent(inout) :: pairs
    real(wp), intent(in) :: skin

    if (allocated(pairs%built)) deallocate (pairs%built)
    if (allocated(pairs%slot_of)) deallocate (pairs%slot_of)
    pairs%asked_skin = skin
  end subroutine forget_pairs

  !> List the tables of a rank's side: what it shares, its margin, and contacts that wait for the first step.
  subroutine decomposition_list_tables(self, tables)
    class(decomposition_t), intent(in) :: self
    type(tables_t), intent(inout) :: tables !! list to add to
    integer(i8) :: bytes

    call self%subdomain%list_tables(tables)
    call self%margin%list_tables(tables)
    call tables%begin('decomposition', per_contact)
    bytes = -1
    if (allocated(self%start_contacts)) bytes = size(self%start_contacts, kind=i8)*(storage_size(self%start_contacts)/8)
    call tables%add('start_contacts', bytes)
    call tables%note('resumed', self%resumed%value)
  end subroutine decomposition_list_tables
end module sg_decomposition
