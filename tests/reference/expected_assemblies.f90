!> Tests. The answers to cards ASSEMBLY and CIRCUITS as the listing must print them, from closed forms in real128.
module expected_assemblies
   use quad_jet, only: qp, degree_q, time_jet, wrap_angle
   use closed_forms_dyads, only: body_t
   use closed_forms_assemblies, only: platform_assemblies, platform, crank_limit
   use closed_forms_four_bars, only: triple_rocker
   use expected_scales, only: listed_t, length_by_hand
   use expected_tables, only: instant_text
   use text_output, only: output_t, put
   implicit none
   private
   public :: put_assemblies_by_hand, put_circuits_by_hand

   !> One assembly: its links, the sign of the Jacobian's determinant, and how far the deck's estimate is from it.
   type :: found_t
      type(body_t), allocatable :: links(:)
      real(qp) :: determinant = 0.0_qp, distance = 0.0_qp
   end type found_t

contains

   !> The table of all assemblies of `m`.
   subroutine put_assemblies_by_hand(o, m)
      type(output_t), intent(inout) :: o
      type(listed_t), intent(in) :: m
      type(found_t), allocatable :: list(:)
      character(80) :: line
      integer :: k

      call find_all(m, list)
      call put(o, '')
      call put(o, ' ASSEMBLIES   T = '//instant_text(m, 0.0_qp)//' '//trim(m%time_unit))
      if (m%name == 'platform') then
         call put(o, '   BLOCK 1: LINKS PLATFORM, LEG-1, LEG-2, LEG-3')
         call put(o, '      UNKNOWNS 4   PATHS 6 = 6 FINITE + 0 AT INFINITY + 0 FAILED   REAL 6')
      else
         call put(o, '   BLOCK 1: LINKS COUPLER, ROCKER')
         call put(o, '      UNKNOWNS 2   PATHS 2 = 2 FINITE + 0 AT INFINITY + 0 FAILED   REAL 2')
      end if
      do k = 1, size(list)
         write (line, '(a, i0, a, f0.4, 3a)') ' ASSEMBLY ', k, '   DISTANCE = ', list(k)%distance, '   DETERMINANTS ', &
            merge('+', '-', list(k)%determinant > 0.0_qp), '   PROVED'
         if (list(k)%distance < 1.0_qp) line = line(:index(line, '=') + 1)//'0'//line(index(line, '=') + 2:)
         call put(o, '')
         call put(o, trim(line)//trim(merge('   CHOSEN BY THE ESTIMATE', '                         ', k == 1)))
         call put_links(o, m, list(k)%links)
      end do
   end subroutine put_assemblies_by_hand

   !> All assemblies at t = 0, the nearest to the estimate first. Determinants: of the derivatives of the loops by the
   !> angles of the links in the deck's order.
   subroutine find_all(m, list)
      type(listed_t), intent(in) :: m
      type(found_t), allocatable, intent(out) :: list(:)
      type(found_t) :: one
      real(qp), allocatable :: positions(:, :)
      integer :: i, k

      if (m%name == 'platform') positions = platform_assemblies()
      if (m%name /= 'platform') allocate (positions(0, 2))
      allocate (list(size(positions, 2)))
      do i = 1, size(list)
         if (m%name == 'platform') then
            one%links = platform(positions(:, i))
            one%determinant = platform_determinant(one%links)
         else
            one%links = triple_rocker(time_jet(0.0_qp), real(3 - 2*i, qp))
            one%determinant = sin(one%links(3)%phi%v - one%links(4)%phi%v)
         end if
         one%distance = distance_from(m, one%links)
         do k = i - 1, 1, -1
            if (list(k)%distance <= one%distance) exit
            list(k + 1) = list(k)
         end do
         list(k + 1) = one
      end do
   end subroutine find_all

   !> Loops from foot 1 over the platform to feet 2 and 3, their derivatives by the angles of platform and legs: the
   !> legs 2 and 3 leave what their normals see of the platform's turn and of leg 1.
   real(qp) function platform_determinant(links) result(determinant)
      type(body_t), intent(in) :: links(:)
      real(qp) :: turn(2, 2), swing(2), across(2)
      real(qp) :: seen(2, 2), joint(2, 3)
      real(qp), parameter :: leg(3) = [14.98_qp, 15.38_qp, 12.0_qp]
      integer :: k

      do k = 1, 3
         joint(:, k) = [links(k + 2)%x%v, links(k + 2)%y%v] + leg(k)*[cos(links(k + 2)%phi%v), sin(links(k + 2)%phi%v)]
      end do
      swing = leg(1)*[-sin(links(3)%phi%v), cos(links(3)%phi%v)]
      do k = 1, 2
         turn(:, k) = [joint(2, 1) - joint(2, k + 1), joint(1, k + 1) - joint(1, 1)]
         across = [cos(links(k + 3)%phi%v), sin(links(k + 3)%phi%v)]
         seen(k, :) = [dot_product(across, turn(:, k)), dot_product(across, swing)]
      end do
      determinant = -(seen(1, 1)*seen(2, 2) - seen(1, 2)*seen(2, 1))
   end function platform_determinant

   !> The root of the sum over the links of squares: of angles off the estimate, in rad, and of places, in
   !> characteristic lengths, up to 0.25.
   real(qp) function distance_from(m, links) result(distance)
      type(listed_t), intent(in) :: m
      type(body_t), intent(in) :: links(:)
      real(qp) :: off(3)
      integer :: i

      distance = 0.0_qp
      do i = 1, size(links)
         off = [links(i)%x%v, links(i)%y%v, links(i)%phi%v] - m%links(i)%position
         off(3) = wrap_angle(off(3))
         distance = distance + off(3)**2 + min(sum(off(:2)**2)/length_by_hand(m)**2, 0.25_qp**2)
      end do
      distance = sqrt(distance)
   end function distance_from

   !> The LINK cards: ten digits of the largest number, angles with seven decimals, less than half a turn off the
   !> estimate.
   subroutine put_links(o, m, links)
      type(output_t), intent(inout) :: o
      type(listed_t), intent(in) :: m
      type(body_t), intent(in) :: links(:)
      character(80) :: line
      character(40) :: form
      real(qp) :: phi, large
      integer :: i

      large = max(length_by_hand(m), maxval(abs(links%x%v)), maxval(abs(links%y%v)))
      write (form, '(a, i0, a)') '(a8, a8, 16x, 2f16.', 9 - floor(log10(large)), ', f16.7)'
      call put(o, '$NAME---LABEL-A|LABEL-B|LABEL-C|REAL-1---------|REAL-2---------|REAL-3---------|')
      do i = 2, size(links)
         phi = m%links(i)%position(3) + wrap_angle(links(i)%phi%v - m%links(i)%position(3))
         write (line, form) 'LINK    ', links(i)%name, links(i)%x%v, links(i)%y%v, phi/degree_q
         call put(o, trim(line))
      end do
   end subroutine put_links

   !> The circuits of the triple rocker. There is one; it begins where the motion from the estimate first turns back, at
   !> the greatest angle of the crank, from where it returns on the other assembly.
   subroutine put_circuits_by_hand(o)
      type(output_t), intent(inout) :: o
      character(120) :: line
      integer :: k

      call put(o, '')
      call put(o, ' CIRCUITS AND BRANCHES, DRIVE ANGLE CRANK')
      call put(o, ' CIRCUIT BRANCH  ASSEMBLY NO.  RANGE OF ANGLE CRANK, DEG')
      do k = 1, 2
         write (line, '(a, i0, a, i0, 13x, 3a)') ' 1       ', k, '       ', 3 - k, in_degrees(-crank_limit()), ' .. ', &
            in_degrees(crank_limit())
         call put(o, trim(line))
      end do
      call put(o, ' DEAD POINTS')
      do k = 1, -1, -2
         call put(o, '   BRANCHES 1 AND 2 MEET AT '//in_degrees(k*crank_limit()) &
            //' DEG, LINKS COUPLER, ROCKER AT THE LIMIT, COLLINEAR')
      end do
   end subroutine put_circuits_by_hand

   !> Ten digits of an angle of two before the point.
   function in_degrees(x) result(text)
      real(qp), intent(in) :: x
      character(:), allocatable :: text
      character(20) :: number

      write (number, '(f20.8)') x/degree_q
      text = trim(adjustl(number))
   end function in_degrees
end module expected_assemblies
