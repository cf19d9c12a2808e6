!> Tests. The results that `make bench` and `make bench-short` judge: blocks against all equations at once, and both
!> against closed forms; one line a comparison.
module bench_results
   use kinds, only: wp
   use mechanism, only: mechanism_t, method_newton
   use test_counter, only: test_counter_t, count_one, conclude, deck_name, sets_of
   use structure, only: structure_report_t, find_structure
   use bench_chains, only: size_t
   use bench_scenes, only: scene_t, new_scene, chain_scene, gap_t, gap_of, error_of, by_closed_form
   implicit none
   private
   public :: judge_all

   !> Rounding moves a position by eps/rcond at most, and moves each derivative by what it moved the one before, over
   !> rcond again where it falls on the weakest direction. That worst case, eps/rcond**3 for an acceleration, would let
   !> anything pass; asked for is `factor` eps/rcond times the derivative's own size, which holds away from change
   !> points. Beside one that is passed the weakest direction is that of the motion, and the worst case is what is owed:
   !> in a parallelogram 5 degrees behind, accelerations of the blocks are off by 1.2E-11, eps/rcond**3 being 8.6E-11.
   real(wp), parameter :: factor = 64.0_wp
   !> Conditions of positions that are not hard.
   real(wp), parameter :: far_from_dead_points = 1.0e2_wp

   !> Chains that are small enough for all equations at once.
   type(size_t), parameter :: small(9) = [size_t('windows', 1), size_t('windows', 10), size_t('windows', 30), &
      size_t('scissor', 2), size_t('scissor', 30), size_t('arm', 10), size_t('arm', 60), size_t('lattice', 3), &
      size_t('lattice', 5)]
   !> Chains for the blocks alone.
   type(size_t), parameter :: large(4) = [size_t('windows', 1000), size_t('scissor', 1000), size_t('arm', 1000), &
      size_t('lattice', 15)]

contains

   !> Compares on the decks `inputs`, all their sets, and on the chains in the directory `decks`, at `steps` instants;
   !> prints the table and, last, the count; ends with status 1 if any differ.
   subroutine judge_all(inputs, decks, steps)
      character(*), intent(in) :: inputs(:), decks
      integer, intent(in) :: steps
      type(test_counter_t) :: counter
      type(scene_t) :: s
      integer :: i

      print '(a)', '', ' RESULTS COMPARED: LARGEST DIFFERENCES IN THE CHARACTERISTIC LENGTH AND RATE', &
         ' CONDITION: of all closure equations, the worst on the way; of large chains, from their number', &
         ' PART: the largest difference in parts of 64 eps CONDITION times the size of the derivative, of rates times that', &
         ' of the positions as well: a large angle is rounded coarsely', '', &
         ' SCENE                COMPARED         STEPS  FLAGGED  CONDITION   POSITION   VELOCITY    ACCEL.     PART'
      do i = 1, size(inputs)
         call judge_deck(trim(inputs(i)), steps, counter)
      end do
      do i = 1, size(small)
         s = chain_scene(decks, trim(small(i)%kind), small(i)%n)
         call judge(s%name, 'BLOCKS, DENSE', gap_of(s, min(steps, 100)), counter)
         call judge_exactly(s, small(i)%kind, min(steps, 100), counter)
      end do
      do i = 1, size(large)
         s = chain_scene(decks, trim(large(i)%kind), large(i)%n)
         call judge_exactly(s, large(i)%kind, min(steps, 10), counter)
      end do
      call judge_change_point(decks, counter)
      call conclude(counter)
   end subroutine judge_all

   !> Every set of a deck of input/, over the time that it asks for.
   subroutine judge_deck(path, steps, counter)
      character(*), intent(in) :: path
      integer, intent(in) :: steps
      type(test_counter_t), intent(inout) :: counter
      type(mechanism_t), allocatable :: sets(:)
      character(:), allocatable :: name
      type(scene_t) :: s
      type(gap_t) :: g, e
      type(structure_report_t) :: f
      integer :: i

      name = deck_name(path)
      sets = sets_of(path)
      do i = 1, size(sets)
         ! All equations at once must be as many as the unknowns.
         f = find_structure(sets(i))
         if (f%redundant > 0) cycle
         s = new_scene(path, name, i)
         s%t0 = s%m%t0
         s%step = (s%m%t1 - s%m%t0)/steps
         g = gap_of(s, steps)
         if (g%has_change_point) g%flagged = 0
         call judge(name//' '//achar(iachar('0') + i), 'BLOCKS, DENSE', g, counter)
         if (.not. associated(s%fast) .or. i > 1) cycle
         e = error_of(s, by_closed_form, steps, 1)
         e%condition = g%condition
         call judge(name//' '//achar(iachar('0') + i), 'FAST, REAL128', e, counter)
      end do
   end subroutine judge_deck

   !> Blocks and the fast closed form of a chain against what is known of the whole chain.
   subroutine judge_exactly(s, kind, steps, counter)
      type(scene_t), intent(in) :: s
      character(*), intent(in) :: kind
      integer, intent(in) :: steps
      type(test_counter_t), intent(inout) :: counter
      type(gap_t) :: g

      g = error_of(s, method_newton, steps, 1)
      g%condition = amplification(s, kind)
      call judge(s%name, 'BLOCKS, EXACT', g, counter)
      if (kind == 'lattice') return
      g = error_of(s, by_closed_form, steps, 1)
      g%condition = amplification(s, kind)
      call judge(s%name, 'FAST, EXACT', g, counter)
   end subroutine judge_exactly

   !> By how much a chain can magnify a rounding: windows pass an angle on as it is; a scissor and an arm add up angles
   !> and, once more, lengths; the lattice by the condition at small sizes, 160 to 500 times n**2.
   pure real(wp) function amplification(s, kind)
      type(scene_t), intent(in) :: s
      character(*), intent(in) :: kind

      select case (kind)
      case ('windows')
         amplification = 4.0_wp*s%chain%n
      case ('lattice')
         amplification = 500.0_wp*real(s%chain%n, wp)**2
      case default
         amplification = 4.0_wp*real(s%chain%n, wp)**2
      end select
   end function amplification

   !> Where all closure equations have no inverse the net can leave its motion; the lattice 7 comes there after 56
   !> steps. What is beyond must be the same motion or be marked: an assembly is never changed in silence. Only
   !> positions are judged, to what a condition of 1.0e7 leaves of them: another assembly is off by 1.0e-3 and more.
   subroutine judge_change_point(decks, counter)
      character(*), intent(in) :: decks
      type(test_counter_t), intent(inout) :: counter
      type(scene_t) :: s
      type(gap_t) :: g

      s = chain_scene(decks, 'lattice', 7)
      g = error_of(s, method_newton, 100, 1)
      g%condition = 1.0e7_wp
      g%worst(2:) = 0.0_wp
      ! Marks are right here.
      g%flagged = 0
      call judge(s%name, 'CHANGE POINT', g, counter)
   end subroutine judge_change_point

   !> One line, and its verdict.
   subroutine judge(name, what, g, counter)
      character(*), intent(in) :: name, what
      type(gap_t), intent(in) :: g
      type(test_counter_t), intent(inout) :: counter
      real(wp) :: part, turn, again
      logical :: good

      ! The error of a position turns the Jacobian that the rates come from: next to a dead point the larger part.
      turn = max(1.0_wp, g%condition/far_from_dead_points)
      ! A large angle is rounded coarsely, and the directions that the rates come from with it.
      again = merge(g%condition, 1.0_wp, g%has_change_point)
      part = maxval(g%worst/(g%size*[1.0_wp, g%size(1)*turn*again, g%size(1)*turn*again**2])) &
         /(factor*epsilon(1.0_wp)*g%condition)
      good = g%instants > 0 .and. g%flagged == 0 .and. part <= 1.0_wp
      print '(1x, a20, 1x, a14, i8, i8, 4es11.1, es9.1, a)', name//repeat(' ', 20), what//repeat(' ', 14), g%instants, &
         g%flagged, g%condition, g%worst, part, trim(merge('       ', ' FAILED', good))
      call count_one(counter, good, name//', '//what)
   end subroutine judge
end module bench_results
