!> Circuits of symmetric mechanisms made by chance against closed forms: twins_by_chance COUNT [FIRST SEED]; the last line
!> is `N passed, N failed`.
program twins_by_chance
   use kinds, only: wp
   use plane_vectors, only: wrap_angle
   use set_analysis, only: set_analysis_t, make_set_analysis, advance_set
   use assemblies, only: assemblies_t, find_assemblies
   use circuits, only: circuits_t, find_circuits
   use twin_circuits, only: twin_t, throw_twin
   use dice, only: dice_t, new_dice
   use test_counter, only: count_seeds
   implicit none

   !> A limit is known to so much in rad and lengths.
   real(wp), parameter :: known = 1.0e-8_wp
   call count_seeds(agrees, 500)

contains

   !> Whether the circuits of the mechanism of `seed` are those of its closed form: as many that are not at rest, the
   !> branches with their ranges, and every assembly of the first instant on a branch.
   logical function agrees(seed)
      integer, intent(in) :: seed
      type(dice_t) :: d
      type(twin_t) :: twin
      type(set_analysis_t) :: s
      type(assemblies_t) :: first
      type(circuits_t) :: found
      logical, allocatable :: taken(:)
      integer :: moving, branches, assemblies, i, k

      d = new_dice(seed)
      call throw_twin(d, twin)
      call make_set_analysis(twin%m, s)
      call advance_set(s, 0.0_wp)
      call find_assemblies(twin%m, s%now%motions(1)%t, first)
      call find_circuits(twin%m, s%now%motions(1), 1, first, found)

      allocate (taken(size(twin%turns)), source=.false.)
      branches = 0
      assemblies = 0
      agrees = s%now%motions(1)%known >= 0
      do i = 1, size(found%branches)
         if (found%list(found%branches(i)%circuit)%rests) cycle
         branches = branches + 1
         assemblies = assemblies + size(found%branches(i)%assemblies)
         do k = 1, size(taken)
            if (taken(k)) cycle
            taken(k) = is_range(found%branches(i)%range, twin%ranges(:, k), twin%turns(k))
            if (taken(k)) exit
         end do
      end do
      moving = count(.not. found%list%rests)
      agrees = agrees .and. all(taken) .and. branches == size(taken) .and. moving == twin%circuits &
         .and. assemblies == twin%assemblies
      if (agrees) return
      print '(3a, i0, 3(a, i0, a, i0), a, i0)', 'FAILED: ', trim(twin%name), ', seed ', seed, ': circuits ', moving, &
         ' of ', twin%circuits, ', branches ', branches, ' of ', size(taken), ', assemblies ', assemblies, ' of ', &
         twin%assemblies, ', ranges ', count(taken)
   end function agrees

   !> Whether two ranges of the drive are one, but for whole turns; of a full turn, whether both are.
   pure logical function is_range(a, b, turns)
      real(wp), intent(in) :: a(2), b(2)
      logical, intent(in) :: turns

      is_range = abs((a(2) - a(1)) - (b(2) - b(1))) <= known
      if (.not. turns) is_range = is_range .and. (all(abs(a - b) <= known) .or. all(abs(wrap_angle(a - b)) <= known))
   end function is_range
end program twins_by_chance
