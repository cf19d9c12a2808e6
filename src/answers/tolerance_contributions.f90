!> Which tolerances count: the sensitivities to all numbers of each quantity that PRINT asks for. They are taken at the
!> printed instant at which the root of the sum of squares is greatest.
module tolerance_contributions
   use kinds, only: wp
   use columns, only: columns_of_rows, forms
   use set_motion, only: set_motion_t
   use rows, only: finished_row_t, word_worst
   implicit none
   private
   public :: contributions_t, contribution_t, record_sensitivities, equal_share_part

   !> A quantity at the instant at which its root of squares is greatest so far.
   type :: contribution_t
      real(wp) :: root = 0.0_wp, worst = 0.0_wp     !< root of squares and worst case, in the unit of the quantity
      real(wp) :: t = 0.0_wp                        !< time of the instant
      real(wp), allocatable :: s(:)                 !< (numbers) the sensitivities; not allocated: none was known yet
   end type contribution_t

   !> The contributions of all tolerances of a set.
   type :: contributions_t
      type(contribution_t), allocatable :: list(:, :, :)   !< (3, 0:2, requests)
      logical, allocatable :: jams(:, :)            !< (numbers, parts) redundant equations do not allow a change
   end type contributions_t

   !> Roots and contributions that differ by less than this part are equal: the first counts.
   real(wp), parameter :: equal_share_part = max(1.0e-9_wp, 4096.0_wp*epsilon(1.0_wp))

contains

   !> Takes the sensitivities of a printed instant. For each quantity the instant with the largest root of squares is
   !> kept.
   subroutine record_sensitivities(shares, motions, rows)
      type(contributions_t), intent(inout) :: shares   !< of the run so far; allocated at the first instant
      type(set_motion_t), intent(in) :: motions   !< at the instant, with their sensitivities
      type(finished_row_t), intent(in) :: rows(:)   !< (requests of the set) at the instant
      integer :: i, j, k, n, c

      if (.not. allocated(shares%list)) then
         allocate (shares%list(3, 0:2, size(motions%rows)))
         allocate (shares%jams(maxval([(size(motions%sensitivities(c)%jams), c=1, motions%count)]), motions%count), &
            source=.false.)
      end if
      do i = 1, size(rows)
         if (.not. (rows(i)%listed .and. allocated(rows(i)%others))) cycle
         associate (others => rows(i)%others, c => rows(i)%part, form => forms(rows(i)%form))
            if (others(1)%word /= word_worst) cycle
            n = size(motions%sensitivities(c)%jams)
            ! The further rows are WORST, RSS, then one for each number.
            do j = form%first, form%last
               associate (at => columns_of_rows(j)%at, &
                  one => shares%list(columns_of_rows(j)%at(1), columns_of_rows(j)%at(2), i))
                  if (at(2) > others(1)%row%known) cycle
                  if (allocated(one%s) .and. others(2)%row%value(at(1), at(2)) &
                     <= one%root*(1.0_wp + equal_share_part)) cycle
                  one%root = others(2)%row%value(at(1), at(2))
                  one%worst = others(1)%row%value(at(1), at(2))
                  one%t = motions%motions(1)%t
                  one%s = [(others(k)%row%value(at(1), at(2)), k=3, 2 + n)]
               end associate
            end do
            shares%jams(:n, c) = shares%jams(:n, c) .or. motions%sensitivities(c)%jams
         end associate
      end do
   end subroutine record_sensitivities
end module tolerance_contributions
