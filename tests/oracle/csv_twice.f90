!> Tests. The results of one deck in n steps and in 2 n: at the instants that both have, the links are in the same
!> places. An assembly that depends on the length of the steps was changed on the way.
module csv_twice
   use quad_jet, only: qp
   use mechanism, only: mechanism_t, instant_count
   use jet_condition, only: sizes_t, sizes_of
   use csv_rows, only: rows_t, read_instant, blame
   use csv_cells, only: whole_text
   implicit none
   private
   public :: compare_steps

   !> Another assembly is farther away than this, of the size of the coordinates; rounding at the worst condition at
   !> which rates are still told, 1e8, leaves less.
   real(qp), parameter :: apart = 1.0e-5_qp

contains

   !> `first`, `second`: files of results of `m` in its steps and in twice as many.
   subroutine compare_steps(m, first, second, wrong)
      type(mechanism_t), intent(in) :: m
      character(*), intent(in) :: first, second
      character(:), allocatable, intent(inout) :: wrong
      type(mechanism_t) :: twice
      type(rows_t) :: one, two
      integer :: units(2), k

      twice = m
      twice%steps = 2*m%steps
      open (newunit=units(1), file=first, status='old', action='read')
      open (newunit=units(2), file=second, status='old', action='read')
      read (units(1), '()')
      read (units(2), '()')
      do k = 0, instant_count(twice) - 1
         call read_instant(units(2), twice, k, two, wrong)
         if (k < twice%steps .and. mod(k, 2) > 0) cycle
         call read_instant(units(1), m, merge(k/2, k - m%steps, k <= twice%steps), one, wrong)
         if (allocated(wrong)) exit
         call compare_bodies(m, one, two, k, wrong)
      end do
      close (units(1))
      close (units(2))
   end subroutine compare_steps

   subroutine compare_bodies(m, one, two, k, wrong)
      type(mechanism_t), intent(in) :: m
      type(rows_t), intent(in) :: one, two
      integer, intent(in) :: k
      character(:), allocatable, intent(inout) :: wrong
      type(sizes_t) :: s
      integer :: i

      if (.not. (all(one%given) .and. all(two%given))) return
      s = sizes_of(m, one%body)
      do i = 1, size(one%body)
         associate (a => one%body(i), b => two%body(i))
            if (max(abs(a%x%v - b%x%v), abs(a%y%v - b%y%v)) <= apart*s%length(0) &
               .and. abs(a%phi%v - b%phi%v) <= apart*s%angle(0)) cycle
            call blame(wrong, 'LINK '//trim(m%links(i)%name)//' IS IN ANOTHER PLACE IN TWICE AS MANY STEPS, AT STEP ' &
               //whole_text(k)//' OF THESE')
         end associate
      end do
   end subroutine compare_bodies
end module csv_twice
